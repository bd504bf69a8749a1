#!/usr/bin/env bash
# Messages about wrong settings, wrong command lines and broken models: each names its place and a remedy, in short sentences.
# usage: messages_cli.sh SUREFOOT
set -u
surefoot=$(realpath "$1")
source "$(dirname "$(realpath "${BASH_SOURCE[0]}")")/contract.sh"
export LC_ALL=C

cases=0
# message NAME CODE PLACE REMEDY COMMAND...: the exit code, nothing on stdout, and one line on stderr. The line begins with PLACE. It has at
# least two sentences and at most 300 bytes, and matches REMEDY. No sentence has more than 25 words. PLACE and REMEDY are extended regular expressions.
message() {
  local name=$1 code=$2 place=$3 remedy=$4; shift 4
  cases=$((cases + 1))
  timeout 20 "$surefoot" "$@" >out 2>err; local got=$?
  [ $got -eq "$code" ] || complain "$name: exit $got, not $code: surefoot $*: $(head -c 300 err)"
  [ -s out ] && complain "$name: something is on stdout: $(head -c 300 out)"
  [ "$(wc -c <err)" -le 300 ] || complain "$name: more than 300 bytes: $(head -c 600 err)"
  [ "$(wc -l <err)" -eq 1 ] || complain "$name: not one line: $(head -c 600 err)"
  grep -qE "^surefoot: ${place:+$place: }[A-Z-]" err || complain "$name: the place is not /$place/: $(head -c 600 err)"
  grep -qE '[.] [A-Z].*[.?]$' err || complain "$name: no sentence of a remedy: $(head -c 600 err)"
  grep -qE -e "$remedy" err || complain "$name: the remedy is not /$remedy/: $(head -c 600 err)"
  local long; long=$(sed 's/\([.?!]\) /\1\n/g' err | awk 'NF > 25')
  [ -z "$long" ] || complain "$name: a sentence has more than 25 words: $long"
}

# ---- inputs ----

# A triangle as glTF. Positions and indices are written as printf takes them.
zero='\0\0\0\0' one='\0\0\200\77' nan='\0\0\300\177'
corners="$zero$zero$zero$one$zero$zero$zero$one$zero"
gltf_json() {  # gltf_json URI MODE: the JSON. URI: further members of the buffer. MODE: 4 is triangles, 0 is points
  printf '{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"name":"tile","primitives":[{"attributes":'
  printf '{"POSITION":0},"indices":1,"mode":%s}]}],"buffers":[{"byteLength":44%s}],' "$2" "$1"
  printf '"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],"accessors":[{"bufferView":0,'
  printf '"componentType":5126,"count":3,"type":"VEC3"},{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}]}'
}
data_uri() { printf ',"uri":"data:application/octet-stream;base64,%s"' "$(printf "$1$2"'\0\0' | base64 -w0)"; }
# gltf FILE POSITIONS INDICES [MODE]
gltf() { gltf_json "$(data_uri "$2" "$3")" "${4:-4}" >"$1"; }
in_bytes() { printf "$(printf '\\%03o\\%03o\\%03o\\%03o' $(($1 & 255)) $(($1 >> 8 & 255)) $(($1 >> 16 & 255)) $(($1 >> 24)))"; }
glb() {  # glb FILE: the sound triangle in one file
  local json; json=$(gltf_json '' 4)
  while [ $((${#json} % 4)) -ne 0 ]; do json+=' '; done
  { printf 'glTF'; in_bytes 2; in_bytes $((12 + 8 + ${#json} + 8 + 44)); in_bytes ${#json}; printf 'JSON%s' "$json"
    in_bytes 44; printf 'BIN\0'; printf "$corners"'\0\0\1\0\2\0\0\0'; } >"$1"
}
obj='v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\n'

glb whole.glb
gltf whole.gltf "$corners" '\0\0\1\0\2\0'
for sound in whole.glb whole.gltf; do
  "$surefoot" bake $sound -o m.walk >out 2>err || complain "the sound model $sound is refused: $(cat err)"
done

# ---- settings ----
settings() { printf "$2" >"$1.toml"; }
settings unknown 'rate_hz = 30\nxylophone = 1\n'
message 'unknown key' 2 'unknown.toml:2' 'See `surefoot config --print` for the keys' walk m.walk --config unknown.toml
settings misspelt 'widht = 640\n'
message 'misspelt key' 1 'misspelt.toml:1' "Did you mean 'width'" config misspelt.toml --check
settings type 'rate_hz = "fast"\n'
message 'wrong type' 2 'type.toml:1' 'Use a number from 1 to 1000 \(Hz\)' walk m.walk --config type.toml
settings limits '\n\nwidth = 8\n'
message 'out of limits' 2 'limits.toml:3' 'Use a whole number from 16 to 16384 \(px\)' walk m.walk --config limits.toml
settings choice 'selector = "best"\n'
message 'unknown choice' 2 'choice.toml:1' 'Use one of flat, .*two-stage' walk m.walk --config choice.toml
settings syntax 'rate_hz = 30\nwidth = = 640\n'
message 'TOML syntax' 2 'syntax.toml:2' 'See https://toml.io for the syntax' walk m.walk --config syntax.toml
settings twice 'rate_hz = 30\nwidth = 640\nrate_hz = 60\n'
message 'key twice' 2 'twice.toml:3' "'rate_hz'. See https://toml.io for the syntax" walk m.walk --config twice.toml
settings profile '[profile.kiosk]\nrate_hz = 30\n'
message 'missing profile' 2 'profile.toml' 'Choose one of kiosk' walk m.walk --config profile.toml --profile museum
settings table '[screen]\nrate_hz = 30\n'
message 'key in a wrong table' 2 'table.toml:1' 'Write keys above all tables, or below \[profile.NAME\]' walk m.walk --config table.toml
settings across 'frame_priority = 50\nraster_priority = 60\n'
message 'rule across keys' 2 'raster_priority \(across.toml:2\)' 'not below frame_priority 50. Lower it' walk m.walk --config across.toml
settings gone 'model = "gone.walk"\nclock = "virtual"\nbackend = "null"\n'
message 'model that is not there' 1 'gone.walk' 'Check the path' walk --config gone.toml

# ---- command lines ----
virtual="--clock virtual --backend null"
message 'unknown option' 2 'walk' "Did you mean '--frames'" walk m.walk --framse 5
message 'unknown command' 2 '' "Did you mean 'walk'" wlak m.walk
message 'missing argument' 2 'bake' "'--out' is required. Add it, or see \`surefoot bake --help\`" bake whole.glb
message 'value out of limits' 2 '--frames 0' 'Use a whole number from 1 to 4000000' walk m.walk $virtual --frames 0
message 'not a number' 2 '--seconds soon' 'Use a number from 0.001 to 1000000 \(s\)' walk m.walk $virtual --seconds soon
message 'options exclude each other' 2 '--seconds' '--frames both .*Remove one of them' walk m.walk $virtual --frames 5 --seconds 5
message 'unknown back end' 2 '--backend vulkan' 'Use one of egl, .*null' walk m.walk --clock virtual --backend vulkan
message 'output folder that cannot be made' 1 '--report /dev/null/report/index.html' '/dev/null is a file.*Name another folder' walk m.walk $virtual --frames 5 --report /dev/null/report
message 'file that cannot be read' 1 'absent.csv' 'Check the path' walk m.walk $virtual --path absent.csv
message 'flag with a value' 2 '--strict' 'Write --strict alone' walk m.walk $virtual --strict=perhaps

message 'rows without --hard' 2 'N9' 'Rows are tested only with --hard. Run: surefoot selftest --hard N9' selftest N9

# ---- models ----
head -c 300 whole.glb >truncated.glb
message 'GLB truncated' 1 'truncated.glb' '300 bytes of 500. Export the model again' bake truncated.glb -o n.walk
{ head -c 200 whole.gltf; printf '\n}}}\n'; } >json.gltf
message 'glTF with wrong JSON' 1 'json.gltf:2' 'Export the model again' bake json.gltf -o n.walk
gltf_json ',"uri":"gone.bin"' 4 >buffer.gltf
message 'buffer missing' 1 'buffer.gltf' "'gone.bin' is missing. Put it there, or export" bake buffer.gltf -o n.walk
gltf_json ",\"uri\":\"data:application/octet-stream;base64,$(head -c 3000 /dev/zero | base64 -w0)\"" 4 >uri.gltf
message 'buffer of another length' 1 'uri.gltf' 'Export the model again' bake uri.gltf -o n.walk
gltf index.gltf "$corners" '\0\0\1\0\11\0'
message 'index out of range' 1 'index.gltf' 'index out of range. Export the model' bake index.gltf -o n.walk
gltf points.gltf "$corners" '\0\0\1\0\2\0' 0
message 'no triangles' 1 'points.gltf' 'Export the model with its triangles' bake points.gltf -o n.walk
gltf nan.gltf "$zero$zero$nan$one$zero$zero$zero$one$zero" '\0\0\1\0\2\0'
message 'position not finite' 1 'nan.gltf' 'not finite.*Export the model' bake nan.gltf -o n.walk
printf "${obj}f 1 2 three\n" >face.obj
message 'OBJ with a bad face' 1 'face.obj' 'first in line 5.*Export the model' bake face.obj -o n.walk
printf 'newmtl a\nmap_Kd gone.png\n' >a.mtl; printf "mtllib a.mtl\nusemtl a\n${obj}f 1/1 2/1 3/1\n" >picture.obj
message 'picture missing' 1 'picture.obj' 'gone.png.*bake what is left with --allow-incomplete' bake picture.obj -o n.walk
printf 'This is a letter, and no model. It is long enough for a header.\n' >letter.glb
message 'text named .glb' 1 'letter.glb' 'Export the model as glTF 2.0' bake letter.glb -o n.walk
head -c 400 m.walk >cut.walk
message '.walk truncated' 1 'cut.walk: header' 'truncated.*Copy the file again, or bake the model again' inspect cut.walk
overwrite() { cp m.walk "$1"; printf "$3" | dd of="$1" bs=1 seek="$2" conv=notrunc status=none; }
overwrite version.walk 8 '\11'
message '.walk of another version' 1 'version.walk: header' 'version 9; .*version 1. Bake the model again' inspect version.walk
overwrite checksum.walk 60 '\245\132\245'
message '.walk with a wrong checksum' 1 'checksum.walk: page 0' 'checksum.*Copy the file again, or bake the model again' inspect checksum.walk
[ -e n.walk ] && complain "a broken model was baked"

[ $cases -eq 35 ] || complain "$cases messages were looked at, not 35"
verdict "$cases messages"
