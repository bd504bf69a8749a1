#!/usr/bin/env bash
# The units as systemd judges them: verify says nothing, security says 1.0 or less, for the service, the template and every drop-in.
# usage: units.sh SYSTEMD-FOLDER SUREFOOTD
set -u
units=$(realpath "$1") surefootd=$(realpath "$2")
command -v systemd-analyze >/dev/null || { echo "SKIPPED: systemd-analyze is not installed"; exit 77; }
systemd-analyze security --help 2>/dev/null | grep -q -- --offline || { echo "SKIPPED: this systemd-analyze knows no --offline"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0
complain() { echo "FAIL: $*"; failures=$((failures + 1)); }

# The program lies elsewhere than it will be installed; nothing else is changed.
put() { sed "s|/usr/sbin/surefootd|$surefootd|" "$units/$1" >"$2"; }
# judge NAME LIMIT: the unit in $work/NAME
judge() {
  local output score
  output=$(systemd-analyze verify --man=no "$work/$1" 2>&1) || complain "verify of $1 fails: $output"
  [ -z "$output" ] || complain "verify of $1 says: $output"
  score=$(systemd-analyze security --offline=true "$work/$1" 2>/dev/null | sed -n 's/.*exposure level for .*: \([0-9.]*\) .*/\1/p')
  echo "$1${2:+ with $2}: ${score:-no score}"
  awk -v s="${score:-99}" 'BEGIN { exit !(s <= 1.0) }' || complain "$1${2:+ with $2}: exposure ${score:-unknown}, above 1.0"
}

for unit in surefootd.service surefootd@left.service; do
  file=${unit/@left/@}
  put "$file" "$work/$unit"
  judge "$unit" ''
  for drop_in in kiosk simulator gpu; do
    [ "$drop_in" = simulator ] && [ "$unit" = surefootd.service ] && continue  # of a channel
    mkdir -p "$work/$unit.d"
    put "surefootd-$drop_in.conf" "$work/$unit.d/$drop_in.conf"
    judge "$unit" "$drop_in"
    rm -r "$work/$unit.d"
  done
done

# A wrong key must be found, or the silence above means nothing.
mkdir -p "$work/wrong"
{ put surefootd.service /dev/stdout; echo 'NoSuchKey=1'; } >"$work/wrong/surefootd.service"
[ -n "$(systemd-analyze verify --man=no "$work/wrong/surefootd.service" 2>&1)" ] || complain "verify does not see an unknown key"

# The template is the service with other names, and nothing else.
plain() { sed -e '/^#/d' -e 's/, channel %i$//' -e 's|surefoot/%i|surefoot|' -e 's|surefoot/surefoot\.toml|surefoot.toml|' "$units/$1"; }
diff <(plain surefootd.service) <(plain surefootd@.service) || complain "the template and the service differ"

# What must not be there, and what must.
grep -qx 'MemoryDenyWriteExecute=no' "$units/surefootd.service" || complain "software GL does not run under MemoryDenyWriteExecute"
grep -qE '^(CPUSchedulingPolicy|PrivateDevices)=' "$units"/surefootd*.service && complain "every thread would be FIFO, or no device seen"
for limit in LimitRTPRIO=80 LimitMEMLOCK=infinity LimitRTTIME=500ms:2s DevicePolicy=closed CapabilityBoundingSet=; do
  grep -qx "$limit" "$units/surefootd.service" || complain "no $limit"
done

# sysusers and tmpfiles, tried on a root of their own.
mkdir -p "$work/root/etc" "$work/root/usr/lib/sysusers.d" "$work/root/usr/lib/tmpfiles.d"
cp "$units/surefoot.sysusers" "$work/root/usr/lib/sysusers.d/surefoot.conf"
cp "$units/surefoot.tmpfiles" "$work/root/usr/lib/tmpfiles.d/surefoot.conf"
if [ "$(id -u)" -eq 0 ]; then
  systemd-sysusers --root="$work/root" surefoot.conf 2>"$work/output" || complain "sysusers: $(cat "$work/output")"
  for group in surefoot-input render video; do
    grep -qE "^$group:.*:(.*,)?surefoot(,|\$)" "$work/root/etc/group" || complain "surefoot is not in $group"
  done
  systemd-tmpfiles --root="$work/root" --create surefoot.conf 2>"$work/output" || complain "tmpfiles: $(cat "$work/output")"
  [ -d "$work/root/var/lib/surefoot" ] || complain "no /var/lib/surefoot"
else
  echo "not root: sysusers.d and tmpfiles.d are not tried out"
fi
if udevadm verify --help >/dev/null 2>&1; then udevadm verify "$units/70-surefoot.rules" || complain "udevadm verify"; fi

if [ $failures -gt 0 ]; then echo "$failures failures"; exit 1; fi
echo "the units hold"
