# Read by tests/bench/run: the group gallery. Not run by itself.
# shellcheck shell=bash

# The runs of Pasman and Jansen 2002, section 5: 100 poses of two spheres, a cylinder and a cow, 640 x 480, on black.
gallery_walk() { # LABEL OPTIONS...: measures, and leaves pictures in WORK/gallery-LABEL/pictures.csv
  local label=gallery-$1
  shift
  measure "$label" "$surefoot" compare "$work/gallery.walk" --resource triangles --frames 100 --pictures 100 --rate 1.6667 --size 640x480 \
    --sky '#000000' --state "$work/no-table" "$@" -o "$work/$label" --json
}

# gallery_rows LABEL SELECTOR AWK: over the pictures of one walk, with t (triangles), full, accuracy and snr set for each.
gallery_rows() {
  awk -F, -v name="\"$2\"" 'FNR > 1 && index($0, name) == 1 { t = $(NF - 6); full = $(NF - 5); accuracy = $(NF - 4); snr = $(NF - 3); '"$3" \
    "$work/gallery-$1/pictures.csv"
}

gallery_group() {
  local accuracy='selector=curve-accuracy,accuracy=200' over under filled snr='' range=()
  if [[ -z "$data" || ! -f "$data/classic/cow/cow.obj" ]]; then
    echo "tests/bench/run: skipped: gallery: SUREFOOT_DATA names no folder with classic/cow/cow.obj" >&2
    return 0
  fi
  "$surefoot" scene gallery --cow "$data/classic/cow/cow.obj" -o "$work/gallery.glb" >&2 || { failed=1; return 0; }
  measure gallery-bake "$surefoot" bake "$work/gallery.glb" --level-ratio 95 --whole-objects --rate 1 --state "$work/no-table" -o "$work/gallery.walk" --json || return 0
  measure cow-curve "$surefoot" inspect "$work/gallery.walk" --curve "$work/cow.svg" --node object --json || return 0
  keep cow_line "$(value line.r_squared)" --scene cow \
    --note "triangles = $(rounded line.triangles) + $(rounded line.per_accuracy) x relative accuracy, by least squares over its levels; the source shows a straight line without a figure."
  gallery_walk budget --budget 200 --selector curve-budget || return 0
  gallery_walk accuracy --budget 100000 --with "$accuracy" || return 0
  snr='if (snr + 0 == snr && snr < 1e9) { if (!n++ || snr < low) low = snr; if (n == 1 || snr > high) high = snr } } END { printf "%.1f to %.1f", low, high }'
  range=("$(gallery_rows budget curve-budget "$snr")" "$(gallery_rows accuracy "$accuracy" "$snr")")
  over=$(gallery_rows budget curve-budget 'if (t > 200) ++n } END { print n + 0 }')
  under=$(gallery_rows accuracy "$accuracy" 'if (accuracy != "inf" && accuracy < 200) ++n } END { print n + 0 }')
  filled=$(gallery_rows budget curve-budget 'if (full > 200) { ++n; if (t >= 190) ++filled } } END { printf "%d of %d", filled, n }')
  unfilled=$(gallery_rows budget curve-budget 'if (full > 200 && t < 190) ++n } END { print n + 0 }')
  keep gallery_runs "$((over + under + unfilled))" --scene gallery \
    --note "Of the pictures whose full detail has more, $filled have at least 190 triangles (wanted: all). SNR ${range[0]} dB with 200 triangles, ${range[1]} dB at 200 rad^-1 (published: 9 to 13 with up to 1200 polygons)."
}
