# The package's settings file: the schema's defaults as `surefoot config` writes them, with the model that the package brings.
# cmake -DTOOL=… -DOUT=… -P settings.cmake
execute_process(COMMAND ${TOOL} config --print --defaults OUTPUT_VARIABLE text COMMAND_ERROR_IS_FATAL ANY)
string(REPLACE "\n# model = \"\"\n" "\nmodel = \"/usr/share/surefoot/room.walk\"\n" with_model "${text}")
if(with_model STREQUAL text)
  message(FATAL_ERROR "the defaults have no line '# model = \"\"'")
endif()
string(REPLACE "# Surefoot settings." "# Surefoot settings, of surefootd; `surefootd --check` reads them." with_model "${with_model}")
file(WRITE ${OUT} "${with_model}")
