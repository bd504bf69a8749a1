# Read by tests/vm/guest.sh: makes what the guests boot from, once, in the cache. Not run by itself.
#
#   kernel/     Debian 12's real-time kernel and its modules, unpacked, never installed, with gpio-sim and vkms built beside them
#   root.img    Debian 12 with systemd, udev and the libraries that the package needs
#   trixie/     Debian 13 with a compiler and libgpiod 2: its programs are built here, in a chroot
#   trixie.img  the same as a disk
#   initrd.gz   finds the disk and the shared folder, and starts guest-init there, or systemd with the unit guest-service
# Each is made under another name and moved into place whole, so an interrupted run leaves nothing half made; NAME.from beside it
# says what it was made from, so a change of one makes only that one anew.
# shellcheck shell=bash

mirror="${SUREFOOT_DEBIAN_MIRROR:-http://deb.debian.org/debian}"
guest_packages=(
  systemd-sysv udev kmod util-linux procps gpiod libgpiod2 libhidapi-hidraw0 libudev1 libtbb12 libtbbmalloc2 libfmt9 libpng16-16 libjpeg62-turbo
  libmeshoptimizer2d libtomlplusplus3 libzstd1 libegl1 libgl1-mesa-dri libosmesa6
)
trixie_packages=(g++ libc6-dev libfmt-dev libglm-dev libtomlplusplus-dev libgpiod-dev)
# What the initrd needs to see the disks and the shared folder; with what each depends on.
initrd_modules=(virtio_pci virtio_blk ext4 9pnet_virtio 9p)

# moved NAME: what was made as $cache/NAME.part is $cache/NAME.
moved() { rm -rf "${cache:?}/$1"; mv "$cache/$1.part" "$cache/$1"; }

# part NAME: the name under which $cache/NAME is being made; nothing is there.
part() { rm -rf "${cache:?}/$1.part"; echo "$cache/$1.part"; }

# unpack FOLDER PACKAGE…: downloads and unpacks packages without installing them.
unpack() {
  local folder=$1 package
  shift
  mkdir -p "$folder/.debs"
  (cd "$folder/.debs" && apt-get download -q "$@" >apt.log 2>&1) || { cat "$folder/.debs/apt.log" >&2; return 1; }
  for package in "$folder"/.debs/*.deb; do dpkg -x "$package" "$folder" || return 1; done
  rm -r "$folder/.debs"
}

# The release of the real-time kernel that the archive has now, as "6.1.0-56-rt-amd64".
kernel_release() { apt-cache depends linux-image-rt-amd64 2>/dev/null | sed -n 's/.*Depends: linux-image-//p' | head -1; }

# gpio-sim is not in Debian's kernel. Its source is; IRQ_SIM, which it needs, is compiled in with one edit: irq_to_desc() is not
# exported to modules, irq_get_irq_data() is.
make_modules() {
  local release=$1 to=$2 work common source headers
  work=$(mktemp -d "$cache/gpio-sim.XXXXXX")
  common="linux-headers-${release/-rt-amd64/-common-rt}"
  unpack "$work/headers" "linux-headers-$release" "$common" linux-kbuild-6.1 || return 1
  unpack "$work/source" linux-source-6.1 || return 1
  tar -C "$work" -xf "$work"/source/usr/src/linux-source-6.1.tar.xz linux-source-6.1/drivers/gpio linux-source-6.1/kernel/irq linux-source-6.1/drivers/gpu/drm/vkms || return 1
  source="$work/linux-source-6.1"
  headers="$work/headers/usr/src/linux-headers-$release"
  # The headers name their common half, and the tools, by where they would be installed.
  sed -i "s#/usr/src/#$work/headers/usr/src/#" "$headers/Makefile"
  mkdir "$work/module"
  cp "$source"/drivers/gpio/{gpio-sim.c,gpiolib.h} "$source/kernel/irq/irq_sim.c" "$work/module"
  sed -i 's/irq_to_desc(irqnum)/irq_data_to_desc(irq_get_irq_data(irqnum))/' "$work/module/irq_sim.c"
  printf 'obj-m += gpio-simx.o\ngpio-simx-y := gpio-sim.o irq_sim.o\n' >"$work/module/Kbuild"
  make -C "$headers" M="$work/module" modules >"$work/make.log" 2>&1 || { tail -20 "$work/make.log" >&2; return 1; }
  install -D -m 644 "$work/module/gpio-simx.ko" "$to/gpio-simx.ko" || return 1
  make_vkms "$release" "$to/vkms.ko" "$work" || echo "vkms was not built: what needs it is skipped" >&2
  rm -rf "$work"
}

# vkms, a card that counts refreshes and shows nothing, is not in Debian's kernel either. Its source builds as it is.
make_vkms() {
  local release=$1 to=$2 work=$3
  mkdir "$work/vkms"
  cp "$work"/linux-source-6.1/drivers/gpu/drm/vkms/* "$work/vkms"
  sed -i 's/obj-\$(CONFIG_DRM_VKMS)/obj-m/' "$work/vkms/Makefile"
  make -C "$work/headers/usr/src/linux-headers-$release" M="$work/vkms" modules >"$work/make.log" 2>&1 || { tail -20 "$work/make.log" >&2; return 1; }
  install -D -m 644 "$work/vkms/vkms.ko" "$to"
}

make_kernel() {
  local release=$1 to
  to=$(part kernel)
  unpack "$to" "linux-image-$release" || return 1
  make_modules "$release" "$to/lib/modules/$release/extra" || return 1
  depmod -b "$to" "$release" || return 1
  echo "$release" >"$to/release"
  moved kernel
}

make_root() {
  local to
  to=$(part root)
  debootstrap --variant=minbase --include="$(IFS=,; echo "${guest_packages[*]}")" bookworm "$to" "$mirror" >"$cache/root.log" 2>&1 ||
    { tail -5 "$cache/root.log" >&2; return 1; }
  rm -rf "$to"/var/cache/apt/archives/*.deb "$to"/usr/share/{doc,locale,man}/*
  mkdir -p "$to/surefoot" "$to/trixie"
  cp -r "$cache/kernel/lib/modules" "$to/lib/"
  mke2fs -q -t ext4 -O ^has_journal -d "$to" "$(part root.img)" 1500M >>"$cache/root.log" 2>&1 || return 1
  rm -rf "$to"
  moved root.img
}

make_trixie() {
  local to
  to=$(part trixie)
  debootstrap --variant=minbase --include="$(IFS=,; echo "${trixie_packages[*]}")" trixie "$to" "$mirror" >"$cache/trixie.log" 2>&1 ||
    { tail -5 "$cache/trixie.log" >&2; return 1; }
  rm -rf "$to"/var/cache/apt/archives/*.deb "$to"/usr/share/{doc,locale,man}/*
  mkdir -p "$to/surefoot"
  mke2fs -q -t ext4 -O ^has_journal -d "$to" "$(part trixie.img)" 2000M >>"$cache/trixie.log" 2>&1 || return 1
  moved trixie.img
  moved trixie
}

make_initrd() {
  local release to module file
  release=$(cat "$cache/kernel/release")
  to=$(part initrd)
  mkdir -p "$to"/{bin,dev,proc,sys,root,modules}
  cp /bin/busybox "$to/bin/" || return 1
  for module in "${initrd_modules[@]}"; do modprobe -d "$cache/kernel" -S "$release" --show-depends "$module"; done |
    awk '$1 == "insmod" && !seen[$2]++ { print $2 }' >"$to/modules/order" || return 1
  while read -r file; do cp "$file" "$to/modules/"; done <"$to/modules/order"
  sed -i 's#.*/##' "$to/modules/order"
  cat >"$to/init" <<'INIT'
#!/bin/busybox sh
# Finds the disk and the shared folder, and starts what is in there: the first process itself, or a unit of systemd.
/bin/busybox --install -s /bin
mount -t proc proc /proc; mount -t sysfs sysfs /sys; mount -t devtmpfs dev /dev
while read -r module; do insmod "/modules/$module"; done </modules/order
tries=0
while [ ! -b /dev/vda ] && [ $tries -lt 50 ]; do sleep 0.1; tries=$((tries + 1)); done
mount -t ext4 /dev/vda /root || { echo "guest: no root disk"; poweroff -f; }
mount -t 9p -o trans=virtio,version=9p2000.L,msize=262144 share /root/surefoot || { echo "guest: no shared folder"; poweroff -f; }
systemd=no
case " $(cat /proc/cmdline) " in *" surefoot.init=systemd "*) systemd=yes ;; esac
mount --move /dev /root/dev; mount --move /proc /root/proc; mount --move /sys /root/sys
if [ $systemd = yes ]; then
  cp /root/surefoot/in/guest-service.service /root/etc/systemd/system/
  mkdir -p /root/etc/systemd/system/multi-user.target.wants
  ln -s ../guest-service.service /root/etc/systemd/system/multi-user.target.wants/
  exec switch_root /root /sbin/init
fi
exec switch_root /root /bin/bash /surefoot/in/guest-init
INIT
  chmod +x "$to/init"
  (cd "$to" && find . | cpio -o -H newc --quiet | gzip -1) >"$(part initrd.gz)" || return 1
  rm -rf "$to"
  moved initrd.gz
}

# made_from NAME RELEASE: a sum over all that the part is made from.
made_from() {
  {
    echo "$2"
    declare -f unpack "make_$1"
    case $1 in
      kernel) declare -f make_modules make_vkms ;;
      root) declare -f make_modules make_vkms; echo "${guest_packages[*]}" ;;  # the modules are in it
      trixie) echo "${trixie_packages[*]}" ;;
      initrd) echo "${initrd_modules[*]}" ;;
    esac
  } | sha256sum | cut -d' ' -f1
}

# make_part NAME RELEASE
make_part() {
  rm -f "$cache/$1.from"
  "make_$1" "$2" && made_from "$1" "$2" >"$cache/$1.from"
}

# make_image: what is missing in the cache, or was made from something else.
make_image() {
  local release name missing=' '
  release=$(kernel_release)
  [[ -n "$release" ]] || return 1
  mkdir -p "$cache"
  for name in kernel root initrd; do
    [[ "$(cat "$cache/$name.from" 2>/dev/null)" == "$(made_from "$name" "$release")" ]] || missing+="$name "
  done
  # Debian 13 has no part of the kernel.
  [[ "$(cat "$cache/trixie.from" 2>/dev/null)" == "$(made_from trixie none)" ]] || missing+='trixie '
  image_was=cached
  if [[ "$missing" == ' ' ]]; then return; fi
  # shellcheck disable=SC2034  # for who reads this file
  image_was=made
  print_title "Making of the guest's image, in $cache:$missing(once; 400 MB to download and 4 GB of disk for all of it)"
  local trixie='' made=1
  if [[ "$missing" == *' trixie '* ]]; then make_part trixie none & trixie=$!; fi
  for name in kernel root initrd; do
    if (( made )) && [[ "$missing" == *" $name "* ]]; then make_part "$name" "$release" || made=0; fi
  done
  if [[ -n "$trixie" ]]; then wait "$trixie" || made=0; fi
  (( made ))
}
