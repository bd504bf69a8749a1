#!/usr/bin/env bash
# The public headers as doxygen reads them (.doxyfile): not one warning, and a comment before each class and struct.
# usage: headers.sh SOURCE_DIR FOLDER    FOLDER: for temporary pages; exit status 77: not looked at, with the reason
# tools/cli declares what the program alone uses: its types need no comment of their own.
set -u
source_dir=${1:?SOURCE_DIR} folder=$(realpath -m "${2:?FOLDER}")
if ! command -v doxygen >/dev/null; then echo "SKIPPED: doxygen is not installed: apt-get install doxygen"; exit 77; fi
mkdir -p "$folder" && folder=$(mktemp -d "$folder/run.XXXXXX") || exit 1  # of this run alone
trap 'rm -rf "$folder"' EXIT

# check_headers SETTING...: prints what is wrong; fails where something is, or where doxygen has seen no header.
check_headers() {
  local warnings=$folder/warnings bad=0
  {
    echo "@INCLUDE = .doxyfile"
    printf '%s\n' "OUTPUT_DIRECTORY = $folder" "WARN_AS_ERROR = NO" "EXTRACT_ALL = NO" "WARN_IF_UNDOCUMENTED = YES" "$@"
  } >"$folder/settings"
  doxygen "$folder/settings" 2>"$warnings" || { cat "$warnings"; return 1; }
  grep -vE 'warning: Member .* is not documented\.$|tools/cli/.*warning: Compound .* is not documented\.$' "$warnings" && bad=1
  if ! ls "$folder"/html/*_8hpp.html >/dev/null 2>&1; then echo "doxygen has read no header"; bad=1; fi
  return $bad
}

# The check itself: good comments pass, and each bad one fails for its own reason.
check_itself() {
  local sample=$folder/sample
  mkdir -p "$sample"
  refused() { # TEXT WHAT
    printf '// A sample.\n#pragma once\n%s\n' "$1" >"$sample/sample.hpp"
    if check_headers "INPUT = $sample" >"$sample/log"; then echo "not refused: $2"; return 1; fi
    grep -q "$2" "$sample/log" || { echo "refused for another reason than '$2':"; cat "$sample/log"; return 1; }
  }
  printf '// A sample.\n#pragma once\n/// A type.\nstruct Good { int member; };\n' >"$sample/sample.hpp"
  check_headers "INPUT = $sample" >"$sample/log" || { echo "a good header is refused:"; cat "$sample/log"; return 1; }
  refused 'struct Bad { int member; };' 'Compound Bad is not documented' &&
    refused $'/// \\nocommand is none.\nstruct Bad {};' 'unknown command' &&
    refused $'/// \\param none There is no such parameter.\nvoid f(int some);' 'not found in the argument list' &&
    refused $'/// An open \\code block.\nstruct Bad {};' 'code'
}

cd "$source_dir" || exit 1
check_itself || exit 1
rm -rf "$folder/html"
check_headers "GENERATE_HTML = YES" || exit 1
echo "$(ls "$folder"/html/*_8hpp.html | wc -l) headers"
