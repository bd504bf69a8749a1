# Read by tests/vm/run and tests/vm/service: what this machine must be, the guest's machine, and what comes back. Not run by itself.
# They set json, keep, build_dir, image_only and, in $share/in, what goes in; guest_devices for other devices. Whatever the guest writes to $share/kept comes back;
# $share/checks.jsonl holds an object a check, and $share/ended is there when it has ended by itself.
# shellcheck shell=bash

source tools/prepare.sh
source tests/vm/image.sh

skip() { echo "SKIPPED: $*"; exit 77; }

cache="${XDG_CACHE_HOME:-$HOME/.cache}/surefoot/vm"
share=''
start=$SECONDS

cleanup() {
  end_children
  if [[ -n "$share" ]]; then rm -rf "$share"; fi
}

# open_guest PACKAGE…: skips where this machine cannot; else image, $share, and the kernel's release. PACKAGE: needed besides QEMU.
open_guest() {
  [[ "$(uname -m)" == x86_64 ]] || skip "the guest is x86_64, this machine is $(uname -m)"
  # shellcheck disable=SC1091
  [[ -r /etc/os-release && "$(. /etc/os-release && echo "${VERSION_CODENAME:-}")" == bookworm ]] ||
    skip "the guest is Debian 12 and runs what is built here, so this must be Debian 12"
  [[ "$(id -u)" == 0 ]] || skip "root is needed to make the guest's disks (debootstrap): run it with sudo"
  local missing
  mapfile -t missing < <(missing_of qemu-system-x86 debootstrap kmod e2fsprogs cpio busybox-static make gcc "$@")
  if (( ${#missing[@]} > 0 )); then
    print_title "Missing Debian packages: ${missing[*]}"
    apt-get update -q >/dev/null 2>&1 || skip "packages are missing and there is no network: ${missing[*]}"
    apt_install "${missing[@]}" || skip "these packages could not be installed: ${missing[*]}"
  fi
  [[ -n "$(kernel_release)" ]] || apt-get update -q >/dev/null 2>&1 || true
  exec 9>"$(mkdir -p "$cache" && echo "$cache/lock")"
  flock -n 9 || skip "another run uses $cache"
  trap cleanup EXIT
  make_image || skip "the guest's image could not be made: is the network there? (logs are in $cache)"
  image_s=$((SECONDS - start))
  if (( image_only )); then echo "$cache: $image_was in $image_s s"; exit 0; fi
  share=$(mktemp -d "$cache/share.XXXXXX")
  mkdir -p "$share/in/kept" "$share/kept"
}

# bake_room MODEL: a small room for the guest to walk through, and beside it the path that begins in it.
bake_room() {
  "$build_dir/surefoot" scene room --scale 0.2 --seed 1 -o "$share/room.glb" >/dev/null 2>&1 &&
    "$build_dir/surefoot" bake "$share/room.glb" --quality draft -o "$1" >/dev/null 2>&1 &&
    cp "$share/room.path.csv" "${1%.walk}.path.csv"
}

# A /dev/kvm that opens and then runs nothing exists (inside some virtual machines), so it has to show that it boots.
kvm_works() {
  local log="$share/kvm.log" probe tries
  [[ -w /dev/kvm ]] || return 1
  timeout 20 qemu-system-x86_64 -machine q35 -accel kvm -cpu host -smp 1 -m 512 -display none -no-reboot -nic none -monitor none \
    -kernel "$cache/kernel/boot/vmlinuz-$(cat "$cache/kernel/release")" -append "console=ttyS0 earlyprintk=serial panic=-1" \
    -serial "file:$log" </dev/null >/dev/null 2>&1 &
  probe=$!
  for (( tries = 0; tries < 50; ++tries )); do
    if grep -q 'Linux version' "$log" 2>/dev/null; then break; fi
    sleep 0.2
  done
  kill "$probe" 2>/dev/null || true
  wait "$probe" 2>/dev/null || true
  grep -q 'Linux version' "$log" 2>/dev/null
}

# What the guest has beside disks and a serial line.
guest_devices=(-display none)

# boot LIMIT_S KERNEL_PARAMETERS: until the guest goes off, its log shown as it comes. Without virtualisation the same kernel is
# emulated, slower.
boot() {
  local limit_s=$1 parameters=$2 from qemu tail_pid
  local accelerator=(-accel tcg -cpu max)
  accelerated=tcg
  if kvm_works 2>/dev/null; then accelerator=(-accel kvm -cpu host) accelerated=kvm; fi
  echo "$accelerated" >"$share/in/accelerated"
  built_s=$((SECONDS - start - image_s))
  print_title "Booting $(cat "$cache/kernel/release") ($accelerated)"
  timeout -k 10 "$limit_s" qemu-system-x86_64 -machine q35 "${accelerator[@]}" -smp 2 -m 2048 "${guest_devices[@]}" -no-reboot -nic none \
    -kernel "$cache/kernel/boot/vmlinuz-$(cat "$cache/kernel/release")" -initrd "$cache/initrd.gz" \
    -append "console=ttyS0 quiet panic=-1 loglevel=3 $parameters" \
    -drive "file=$cache/root.img,if=virtio,format=raw,snapshot=on" -drive "file=$cache/trixie.img,if=virtio,format=raw,snapshot=on" \
    -virtfs "local,path=$share,mount_tag=share,security_model=none" -serial "file:$share/kept/console.log" -monitor none </dev/null &
  qemu=$!
  from=$SECONDS
  tail -n +1 -F --pid="$qemu" "$share/kept/guest.log" 2>/dev/null &
  tail_pid=$!
  qemu_status=0
  wait "$qemu" || qemu_status=$?
  wait "$tail_pid" || true
  guest_s=$((SECONDS - from))
}

# sum_up: what came back goes to $keep, with summary.json. Fails where a check failed, none passed, or the guest did not end by itself.
sum_up() {
  local passed failed not_run ended=false verdict=passed
  mkdir -p "$keep"
  cp -r "$share/kept/." "$keep/"
  count() { grep -c "\"verdict\": \"$1\"" "$share/checks.jsonl" 2>/dev/null || true; }
  passed=$(count pass) failed=$(count fail) not_run=$(count 'not run')
  [[ -f "$share/ended" ]] && ended=true
  if [[ "$ended" != true || "${failed:-0}" != 0 || "${passed:-0}" == 0 ]]; then verdict=failed; fi
  {
    printf '{"verdict": "%s", "passed": %d, "failed": %d, "not_run": %d, "kernel": "%s", "accelerator": "%s", "image": "%s", ' \
      "$verdict" "${passed:-0}" "${failed:-0}" "${not_run:-0}" "$(cat "$cache/kernel/release")" "$accelerated" "$image_was"
    printf '"image_s": %d, "build_s": %d, "guest_s": %d, "guest_ended": %s, "checks": [\n' "$image_s" "$built_s" "$guest_s" "$ended"
    sed 's/$/,/; $ s/,$//' "$share/checks.jsonl" 2>/dev/null || true
    printf ']}\n'
  } >"$keep/summary.json"
  if (( json )); then cat "$keep/summary.json" >&3; fi

  print_title "Summary"
  grep -hE '^\[ (FAIL|not run)' "$keep/guest.log" || true
  [[ "$ended" == true ]] || echo "the guest did not end by itself (QEMU's status $qemu_status): see $keep/console.log"
  echo "image $image_was in $image_s s, built in $built_s s, guest $guest_s s; all in $((SECONDS - start)) s"
  echo "$verdict: ${passed:-0} passed, ${failed:-0} failed, ${not_run:-0} not run; see $keep"
  [[ "$verdict" == passed ]]
}
