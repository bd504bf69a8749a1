#!/usr/bin/env bash
# Old command lines and settings files: what tests/known_names.txt lists is still taken, or is refused by name with what to write
# instead; and what the tool takes today is listed there.
# usage: old_names_cli.sh SUREFOOT SOURCES
set -u
surefoot=$(realpath "$1") sources=$(realpath "$2")
source "$sources/tests/contract.sh"
# What follows a refused name: the new one or what to do instead, and a remedy. tests/config/wrong_use_test.cpp holds it against the messages.
by_name="(is now '[^']+'|was removed)[.] [A-Z]"

# What the tool takes today, in the list's form.
options_of() { "$surefoot" $1 --help | grep -oE '^ +(-[a-z],)?--[a-z][a-z-]*' | grep -oE -e '--[a-z-]+' | grep -vx -e --help | sed "s/^/$1 /"; }
commands_of() { "$surefoot" $1 --help | sed -n '/^Subcommands:/,/^$/s/^  \([a-z][a-z-]*\) .*/\1/p'; }
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
      expect 1 "old.toml:1: The name '${name#key }' $by_name" config old.toml --check
      expect 2 "old.toml:1: The name '${name#key }' $by_name" walk f.walk --config old.toml ;;
    *' hidden') # taken, and not shown
      expect 2 . ${name% hidden} 1
      grep -q 'is unknown' err && complain "'${name% hidden}' is not taken, and not refused by name: $(cat err)" ;;
    *) expect 2 "The name '--[a-z-]+' $by_name" $name 1 ;;
  esac
done <known

# The script for the tests has options of its own. A wrong word is named, with those that it may be.
# refused PATTERN WORD...: exit 2, and one line that matches PATTERN
refused() {
  local pattern=$1; shift
  timeout 100 "$sources/tools/test" "$@" >out 2>err; local got=$?
  [ $got -eq 2 ] || complain "exit $got, not 2: tools/test $*"
  [ "$(wc -l <err)" -eq 1 ] && grep -qE "$pattern" err || complain "tools/test $* says '$(head -c 300 err)'"
}
for old in --matrix --release-only; do refused "'$old' is called '--[a-z -]+' now" $old; done
refused "'--nihgtly' is no option.*--nightly" --nihgtly
refused "'extra' is superfluous" --quick extra
refused "no part of the night is named 'fuzers'.* fuzzers " --nightly slow fuzers
for words in --help '--nightly --help' '--nightly slow -h'; do
  timeout 100 "$sources/tools/test" $words >out 2>err; got=$?
  [ $got -eq 0 ] || complain "exit $got of tools/test $words"
  grep -q '^Usage: tools/test' out || complain "tools/test $words shows no help"
done
verdict "old names"
