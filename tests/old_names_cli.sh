#!/usr/bin/env bash
# Old command lines and settings files: what tests/known_names.txt lists is still taken, or is refused by name with what to write
# instead; and what the tool takes today is listed there.
# usage: old_names_cli.sh SUREFOOT SOURCES
set -u
surefoot=$(realpath "$1") sources=$(realpath "$2")
source "$sources/tests/contract.sh"
by_name='is called .* now|is no longer there'

# What the tool takes today, in the list's form.
options_of() { "$surefoot" $1 --help | grep -oE '^ +(-[a-z],)?--[a-z][a-z-]*' | grep -oE -e '--[a-z-]+' | grep -vx -e --help | sed "s/^/$1 /"; }
commands_of() { "$surefoot" $1 --help | sed -n '/^Subcommands:/,/^$/s/^  \([a-z]\+\) .*/\1/p'; }
for command in $(commands_of ''); do
  for sub in '' $(commands_of "$command"); do options_of "$command${sub:+ $sub}"; done
done >today
"$surefoot" config --print --defaults | sed -n 's/^# \([a-z_]\+\) = .*/key \1/p' >>today
[ "$(wc -l <today)" -gt 150 ] || complain "only $(wc -l <today) names were found in --help and the settings page"
grep -v '^#' "$sources/tests/known_names.txt" >known

while read -r name; do
  grep -qxF "$name" known || complain "'$name' is new: add it to tests/known_names.txt, where it stays"
done <today

while read -r name; do
  grep -qxF "$name" today && continue
  case $name in
    'key '*)
      printf '%s = 1\n' "${name#key }" >old.toml
      expect 1 "old.toml:1: '${name#key }' ($by_name)" config old.toml --check
      expect 2 "old.toml:1: '${name#key }' ($by_name)" walk f.walk --config old.toml ;;
    *' hidden') # taken, and not shown
      timeout 100 "$surefoot" ${name% hidden} 1 >out 2>err
      grep -q 'not expected' err && complain "'${name% hidden}' is not taken, and not refused by name: $(cat err)" ;;
    *) expect 2 "'--[a-z-]+' ($by_name)" $name 1 ;;
  esac
done <known

# The script for the tests has options of its own.
for old in --matrix --release-only; do
  "$sources/tools/test" $old >out 2>err; got=$?
  [ $got -eq 2 ] || complain "exit $got, not 2: tools/test $old"
  grep -qE "'$old' is called '--[a-z -]+' now" err || complain "tools/test $old says '$(head -c 300 err)'"
done
verdict "old names"
