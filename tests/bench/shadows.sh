# The group `shadows` of tests/bench/run, which sources this: no shadows, baked ones and a shadow map of everything, in the town at 8, 12 and
# 18 h. What each takes of a frame's CPU time, and how near its picture is to a ray to the sun for each pixel.
# shellcheck shell=bash
# shellcheck disable=SC2034,SC2154 # work, build, failed: of run

shadow_hours=(8 12 18)
shadow_of=(--command "tests/bench/run shadows")

# WORK/shadows/shadows.jpg: rows are methods, columns hours, all of one pose.
shadow_picture() { # POSE MAP
  local at=$work/shadows method hour label strip
  command -v convert >/dev/null || { echo "tests/bench/run: convert is not installed (Debian: imagemagick); no shadows.jpg" >&2; return 0; }
  for method in none baked "$2" rays; do
    strip=()
    for hour in "${shadow_hours[@]}"; do
      label=${method//_/ }
      [[ $method != none ]] || label='no shadows'
      strip+=('(' "$(printf '%s/%02dh-%s-%s.png' "$at" "$hour" "$1" "$method")" -resize 440x248 -gravity northwest -pointsize 15 -fill white
        -undercolor '#000c' -annotate +4+4 " $hour h, $label " ')')
    done
    convert "${strip[@]}" +append "$at/strip-$method.png" || { failed=1; return 0; }
  done
  convert "$at"/strip-{none,baked,"$2",rays}.png -append -strip -quality 62 "$at/shadows.jpg" || failed=1
  echo "tests/bench/run: $at/shadows.jpg: rows none, baked, ${2//_/ }, rays; columns ${shadow_hours[*]} h" >&2
}

shadow_takes() { # PROMISE HOUR METHOD
  local at=h$2.$3
  keep "$1" "$(value "$at.more_percent.1")" --scene "lamps, $2 h, ${3//_/ }" "${shadow_of[@]}" \
    --spread "$(value "$at.more_percent.0") to $(value "$at.more_percent.2")" \
    --note "$(value "$at.frame_ms.1") ms of CPU time, $(value "h$2.none.frame_ms.1") without shadows."
}

# SUREFOOT_SHADOW_POSES=N shortens it, to see that it runs: no figure is kept then.
shadows_group() {
  local poses=${SUREFOOT_SHADOW_POSES:-4} hour method
  rm -rf "$work/shadows"
  mkdir -p "$work/shadows"
  measure shadows "$build/tests/bench_shadow_methods" "$work/lamps.walk" "$poses" 5 "$work/shadows" || return 0
  shadow_picture "$((poses / 2))" map_60_m
  [[ -z "${SUREFOOT_SHADOW_POSES:-}" ]] || return 0
  for hour in "${shadow_hours[@]}"; do
    shadow_takes shadow_baked_percent "$hour" baked
    for method in map_60_m map_kept; do shadow_takes shadow_map_percent "$hour" "$method"; done
    for method in none baked map_30_m map_60_m map_120_m map_240_m; do
      keep shadow_db "$(value "h$hour.$method.psnr_db")" --scene "lamps, $hour h, ${method//_/ }" "${shadow_of[@]}" \
        --note "SSIM $(value "h$hour.$method.ssim"), FLIP $(value "h$hour.$method.flip")."
    done
  done
}
