#!/usr/bin/env bash
# Does each text that the guest of tests/vm/service waits for stand in a source file? usage: service_texts.sh TOP
set -euo pipefail
cd "$1"
bad=0 seen=0
while IFS= read -r line; do
  text=${line#*=\'} text=${text%\'}
  seen=$((seen + 1))
  if ! grep -rqF --include='*.cpp' -- "$text" systemd tools/walk tools/monitor input rt; then
    echo "tests/vm/service-texts: no source file has '$text'"
    bad=1
  fi
done < <(grep '^text_' tests/vm/service-texts)
echo "$seen texts"
(( seen > 0 && bad == 0 ))
