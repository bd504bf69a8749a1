#!/usr/bin/env bash
# The Debian package: built by cpack, looked through, installed, upgraded and purged below a root of its own, without systemd
# running there (that is for a guest: tests/vm). Maintainer scripts run outside it, with DPKG_ROOT.
# usage: package.sh BUILD-FOLDER
set -u
build=$(realpath "$1")
skip() { echo "SKIPPED: $*"; exit 77; }
for tool in cpack dpkg-deb dpkg-shlibdeps systemd-sysusers; do
  command -v $tool >/dev/null || skip "$tool is not installed"
done
as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v fakeroot >/dev/null || skip "neither root nor fakeroot"
  as_root=(fakeroot)
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0
complain() { echo "FAIL: $*"; failures=$((failures + 1)); }

cd "$build" || exit 1
cpack -G DEB -B "$work/out" >"$work/cpack.log" 2>&1 || { tail -20 "$work/cpack.log"; echo "cpack fails"; exit 1; }
deb=$(ls "$work"/out/*.deb)
echo "$(basename "$deb"): $(( $(stat -c %s "$deb") / 1024 )) KiB"

# Content.
dpkg-deb -c "$deb" >"$work/content"
for file in usr/bin/surefoot usr/sbin/surefootd usr/lib/systemd/system/surefootd.service usr/lib/systemd/system/surefootd@.service \
    usr/lib/sysusers.d/surefoot.conf usr/lib/tmpfiles.d/surefoot.conf usr/lib/udev/rules.d/70-surefoot.rules \
    etc/surefoot/surefoot.toml usr/share/surefoot/room.walk usr/share/man/man8/surefootd.8 usr/share/man/man1/surefoot.1 usr/share/man/man1/surefoot-walk.1 \
    usr/share/man/man5/surefoot.toml.5 usr/share/doc/surefoot/copyright \
    usr/share/doc/surefoot/examples/surefootd-kiosk.conf usr/share/doc/surefoot/examples/surefootd-screen.conf; do
  grep -qE " \./$file\$" "$work/content" || complain "the package lacks $file"
done
awk '{ print $2 }' "$work/content" | grep -qv '^root/root$' && complain "something is not root's"
awk '{ print $1 }' "$work/content" | grep -qE '^.{8}w' && complain "something may be written by everybody"
grep -vE ' \./(usr|etc)?(/|$)' "$work/content" | grep -q . && complain "files outside /usr and /etc"
dpkg-deb -e "$deb" "$work/control"
grep -qx '/etc/surefoot/surefoot.toml' "$work/control/conffiles" || complain "the settings are no conffile"
for script in postinst prerm postrm; do sh -n "$work/control/$script" || complain "$script"; [ -x "$work/control/$script" ] || complain "$script cannot be run"; done
for package in libc6 libegl1 libtbb systemd; do
  grep -E '^Depends:' "$work/control/control" | grep -q "$package" || complain "does not depend on $package: $(grep ^Depends "$work/control/control")"
done

# What is in it works: the settings are taken, every key is shown, and the room can be walked through.
dpkg-deb -x "$deb" "$work/files"
"$work/files/usr/sbin/surefootd" --config "$work/files/etc/surefoot/surefoot.toml" --check >"$work/output" 2>&1 || complain "the settings: $(cat "$work/output")"
[ "$(grep -cE '^#? ?[a-z_]+ = ' "$work/files/etc/surefoot/surefoot.toml")" -ge 25 ] || complain "the settings lack keys"
"$work/files/usr/bin/surefoot" walk "$work/files/usr/share/surefoot/room.walk" --clock virtual --backend null --frames 30 >"$work/output" 2>&1 ||
  complain "the room: $(cat "$work/output")"
readelf -S "$work/files/usr/sbin/surefootd" | grep -q '\.debug_info' && complain "not stripped"

# Installed, upgraded, purged. The dependencies are not there, and nothing is started.
root=$work/root
mkdir -p "$root/var/lib/dpkg/info" "$root/var/lib/dpkg/updates" "$root/etc"
touch "$root/var/lib/dpkg/status" "$root/var/lib/dpkg/available"
package() { "${as_root[@]}" dpkg --root="$root" --log=/dev/null --force-depends --force-not-root --force-script-chrootless --force-confold "$@" >"$work/output" 2>&1 || complain "dpkg $*: $(cat "$work/output")"; }
package -i "$deb"
[ -x "$root/usr/sbin/surefootd" ] || complain "nothing was installed"
grep -q '^surefoot:' "$root/etc/passwd" 2>/dev/null || complain "no user surefoot"
grep -qE '^surefoot-input:.*surefoot' "$root/etc/group" 2>/dev/null || complain "surefoot is not in surefoot-input"
[ -d "$root/var/lib/surefoot" ] || complain "no state folder"

# A newer version, with other settings, over changed ones and a state.
echo 'rate_hz = 60' >>"$root/etc/surefoot/surefoot.toml"
echo 1 >"$root/var/lib/surefoot/emergency-stop"
dpkg-deb -R "$deb" "$work/newer"
sed -i 's/^Version: .*/Version: 99.0/' "$work/newer/DEBIAN/control"
echo '# newer' >>"$work/newer/etc/surefoot/surefoot.toml"
"${as_root[@]}" dpkg-deb -b "$work/newer" "$work/newer.deb" >/dev/null
package -i "$work/newer.deb"
grep -q '^Version: 99.0' "$root/var/lib/dpkg/status" || complain "not upgraded"
grep -qx 'rate_hz = 60' "$root/etc/surefoot/surefoot.toml" || complain "the upgrade threw the settings away"
[ -f "$root/var/lib/surefoot/emergency-stop" ] || complain "the upgrade threw the state away"

package -r surefoot
[ ! -e "$root/usr/sbin/surefootd" ] || complain "removed, and still there"
[ -f "$root/etc/surefoot/surefoot.toml" ] || complain "a removal threw the settings away"
[ -f "$root/var/lib/surefoot/emergency-stop" ] || complain "a removal threw the state away"
package -P surefoot
left=$(cd "$root" && find . -path ./var/lib/dpkg -prune -o \( -iname '*surefoot*' \) -print)
[ -z "$left" ] || complain "left behind by the purge: $left"

if [ $failures -gt 0 ]; then echo "$failures failures"; exit 1; fi
echo "the package holds; not shown here: that it starts (tests/vm)"
