# The group `picture OLD NEW` of tests/bench/run, which sources this: what two builds show in the same time, against full detail of the
# older one. Old and new walk in turns; each has its own bake, cost table and fit. Pictures are compared at the poses of each ledger.
# shellcheck shell=bash
# shellcheck disable=SC2034,SC2154 # work, top, data, build, failed: of run

# NAME SCENE PATH LIFT, a line a scene. Both builds import the same files; generated scenes are made by OLD, and the garden by NEW:
# older builds may not have it.
picture_sources() {
  echo "forest $picture_work/forest.glb $picture_work/forest.path.csv 0"
  echo "town $picture_work/town.glb $picture_work/town.path.csv 0"
  echo "garden $picture_work/garden.glb $picture_work/garden.path.csv 0"
  [[ -d "$data" ]] || return 0
  echo "hospital $data/interior/hospital/hospital_three_floors.glb $top/tests/bench/paths/hospital-tour.csv 0"
  echo "keflavik $data/outdoor/flightgear-keflavik/keflavik.glb $top/tests/bench/paths/keflavik-tour.csv 0"
  echo "candela $data/outdoor/candela-city/candela_city.glb $data/outdoor/candela-city/recorded_path.csv 1.5"
  echo "ravenbridge $data/interior/ravenbridge-mansion/ravenbridge_mansion.glb $data/interior/ravenbridge-mansion/recorded_path.csv 1.5"
  echo "cocoa $data/outdoor/cocoa-temple/cocoa_temple.glb $data/outdoor/cocoa-temple/recorded_path.csv 1.5"
}

picture_generate() { # NAME SCALE BUILD
  [[ -f "$picture_work/$1.glb" && -f "$picture_work/$1.path.csv" ]] || "$3/surefoot" scene "$1" --scale "$2" --seed 1 -o "$picture_work/$1.glb" >&2
}

# The work of a build: another program has another folder, so its bakes and fits are its own.
picture_folder() { echo "$picture_work/$(sha256sum "$1/surefoot" | cut -c 1-12)"; }

# Bakes and fits NAME by the build in folder $1, unless it is done. state: the table alone; fitted: with the model's fit.
picture_set_up() { # BUILD NAME SCENE PATH LIFT
  local folder side=new
  [[ $1 != "$old" ]] || side=old
  folder=$(picture_folder "$1")
  mkdir -p "$folder"
  if [[ ! -f "$folder/state/costs.toml" ]]; then
    measure "picture calibrate $side" "$1/surefoot" calibrate --state "$folder/state.new" --json || return 1
    rm -rf "$folder/state"
    mv "$folder/state.new" "$folder/state"
  fi
  if [[ ! -f "$folder/$2.walk" ]]; then
    measure "picture bake $side $2" "$1/surefoot" bake "$3" -o "$folder/$2.walk" --state "$folder/state" --json || return 1
  fi
  if [[ ! -d "$folder/fitted-$2" ]]; then
    rm -rf "$folder/fitting"
    cp -r "$folder/state" "$folder/fitting"
    measure "picture fit $side $2" "$1/surefoot" calibrate "$folder/$2.walk" --path "$4" --lift "$5" --state "$folder/fitting" --json || return 1
    mv "$folder/fitting" "$folder/fitted-$2"
  fi
}

# p50 of old's full detail of the forest, ms: how fast this machine is now.
full_detail_ms() {
  local folder
  folder=$(picture_folder "$old")
  measure "picture full detail" "$old/surefoot" walk "$folder/forest.walk" --path "$picture_work/forest.path.csv" --selector flat --late float \
    --no-check --no-occlusion --rate 3 --frames "$picture_flat_frames" --state "$folder/state" --json || return 1
  full_ms=$(value frame_ms.p50) || return 1
}

# The pictures AT/walk of a walk with the ledger AT/ledger.csv, against full detail at the same poses, which goes to AT/full. Values are those of
# bench_picture_difference.
beside_full_detail() { # LABEL AT PATH LIFT RATE EVERY SUREFOOT MODEL STATE
  local frames
  measure "$1 poses" "$build/tests/bench_ledger_poses" "$3" "$4" "$5" "$2/ledger.csv" "$6" "$2/poses.csv" || return 1
  frames=$(value frames)
  # Four frames at each pose, for the prepared region to settle; every fourth is a picture.
  measure "$1 reference" "$7" walk "$8" --path "$2/poses.csv" --selector flat --clock virtual --cost-scale 0.01 --no-check --no-occlusion \
    --rate 30 --frames "$frames" --state "$9" --snap "$2/full" --every 4 --json || return 1
  measure "$1 difference" "$build/tests/bench_picture_difference" "$2/walk" "$2/full"
}

# One walk and its pictures against old's full detail. Sets psnr, worst, ssim, missed, walked, and unused of new.
picture_walk() { # LABEL BUILD STATE RATE NAME PATH LIFT
  local folder old_folder at=$picture_work/walks/$5-$1 every
  folder=$(picture_folder "$2")
  every=$(awk "BEGIN { printf \"%.0f\", 2 * $4 }")
  rm -rf "$at"
  mkdir -p "$at"
  measure "picture walk $1 $5" "$2/surefoot" walk "$folder/$5.walk" --path "$6" --lift "$7" --rate "$4" --seconds "$picture_seconds" \
    --state "$3" --ledger "$at/ledger.csv" --snap "$at/walk" --every "$every" --json || return 1
  missed=$(value misses) walked=$(value frames) unused=
  [[ $2 == "$old" ]] || unused=$(awk "BEGIN { printf \"%.3f\", 0.1 * $4 * $(value unused_ms.mean) }")  # of the period, in per cent
  old_folder=$(picture_folder "$old")
  beside_full_detail "picture $1 $5" "$at" "$6" "$7" "$4" "$every" "$old/surefoot" "$old_folder/$5.walk" "$old_folder/state" || return 1
  psnr=$(value psnr_db) worst=$(value worst_psnr_db) ssim=$(value ssim)
  echo "tests/bench/run: $5, $1: $psnr dB, worst $worst ($at/walk/$(value worst)), SSIM $ssim, FLIP $(value flip), $missed of $walked missed" >&2
}

middle_of() { printf '%s\n' "$@" | sort -g | sed -n "$((($# + 1) / 2))p"; }
min_and_max() { printf '%s\n' "$@" | sort -g | sed -n '1p;$p' | paste -sd ' ' | sed 's/ / to /'; }

# Walks NAME in turns by every pass. Fills db, low, similar, late and idle: [PASS] has a figure a turn.
# full_before and full_after are the machine's speed.
picture_turns() { # NAME PATH LIFT
  local turn pass side state rate label stressed
  db=() low=() similar=() late=() idle=()
  full_detail_ms || return 1
  full_before=$full_ms
  picture_rate=$(awk "BEGIN { printf \"%.4f\", 1000 / (1000 / 30 * $full_before / 65) }")
  for (( turn = 1; turn <= picture_rounds; ++turn )); do
    for pass in "${picture_passes[@]}"; do
      side=$new rate=$picture_rate stressed=
      case $pass in old | old-half) side=$old ;; esac
      case $pass in *-half) rate=$(awk "BEGIN { printf \"%.4f\", 2 * $rate }") ;; esac
      state=$(picture_folder "$side")/fitted-$1
      case $pass in
        new-not-fitted) state=$(picture_folder "$side")/state ;;
        new-loaded) load 600 "$1 beside load" || return 1; stressed=yes ;;
      esac
      label=$pass-$turn
      picture_walk "$label" "$side" "$state" "$rate" "$1" "$2" "$3" || { [[ -z "$stressed" ]] || unload; return 1; }
      [[ -z "$stressed" ]] || unload
      db[$pass]+=" $psnr" low[$pass]+=" $worst" similar[$pass]+=" $ssim" late[$pass]+=" $missed" idle[$pass]+=" $unused"
    done
  done
  full_detail_ms || return 1
  full_after=$full_ms
}

# A page of the last turn's pictures: a row a pose, full detail beside what each pass showed there.
picture_page() { # NAME
  local page=$picture_work/$1.html pass image file turn=$picture_rounds
  {
    echo "<!doctype html><html lang=en><meta charset=utf-8><title>$1: old and new beside full detail</title>"
    echo "<style>body { font: 1rem sans-serif } td { padding: .2rem } img { width: 30rem } p { max-width: 45rem }</style><h1>$1</h1>"
    echo "<p>Pictures of walks at $(awk "BEGIN { printf \"%.1f\", 1000 / $picture_rate }") ms a frame, and at half of that where a column says so."
    echo "Full detail stands at the poses of old. A walk that misses a frame is a pose behind it.</p><table><tr><th>full detail"
    for pass in "${picture_passes[@]}"; do echo "<th>$pass: $(awk -v all="${db[$pass]}" 'BEGIN { n = split(all, x, " "); print x[n] }') dB"; done
    for file in "$picture_work/walks/$1-old-$turn/walk/"*.png; do
      [[ -f "$file" ]] || continue
      image=${file##*/}
      echo "<tr><td><img loading=lazy alt='full detail' src='walks/$1-old-$turn/full/$image'>"
      for pass in "${picture_passes[@]}"; do echo "<td><img loading=lazy alt='$pass' src='walks/$1-$pass-$turn/walk/$image'>"; done
    done
    echo "</table></html>"
  } >"$page"
  echo "tests/bench/run: pictures side by side: $page" >&2
}

# keep_difference PROMISE NAME PASS LESS [WORDS]: the median over the turns of what PASS has more than LESS, in dB
keep_difference() {
  local more less i gains=() note
  read -ra more <<<"${db[$3]}"
  read -ra less <<<"${db[$4]}"
  for i in "${!more[@]}"; do gains+=("$(awk "BEGIN { printf \"%.3f\", ${more[i]} - ${less[i]} }")"); done
  note="$3 ${db[$3]# } dB (worst pictures ${low[$3]# }, SSIM ${similar[$3]# }, missed ${late[$3]# }), $4 ${db[$4]# } dB"
  note+=" (worst pictures ${low[$4]# }, SSIM ${similar[$4]# }, missed ${late[$4]# }); $(awk "BEGIN { printf \"%.2f\", 1000 / $picture_rate }") ms a frame${5:+ $5};"
  note+=" full detail of the forest $full_before ms before, $full_after after."
  keep "$1" "$(middle_of "${gains[@]}")" --scene "$2" --spread "$(min_and_max "${gains[@]}")" --note "$note"
}

picture_scene() { # NAME SCENE PATH LIFT
  local side try
  for side in "$old" "$new"; do picture_set_up "$side" "$@" || { failed=1; return 0; }; done
  for (( try = 1; ; ++try )); do
    picture_turns "$1" "$3" "$4" || { failed=1; return 0; }
    if awk "BEGIN { d = $full_after / $full_before; exit !(d <= 1.05 && d >= 1 / 1.05) }"; then break; fi
    echo "tests/bench/run: $1: full detail of the forest took $full_before ms before and $full_after after: the machine changed" >&2
    [[ -z "$picture_quick" ]] || break
    if (( try == 3 )); then echo "tests/bench/run: $1: given up after three tries" >&2; failed=1; return 0; fi
  done
  picture_page "$1"
  local promise=picture_gain
  case $1${picture_forms:+, forms} in
    candela | ravenbridge | cocoa) promise=picture_gain_$1 ;;
    "candela, forms" | "ravenbridge, forms") promise=picture_forms_houses ;;
    "cocoa, forms" | "forest, forms") promise=picture_forms_$1 ;;
    *", forms") promise=picture_forms_others ;;
  esac
  keep_difference "$promise" "$1" new old
  keep picture_db "$(read -ra all <<<"${db[new]}"; middle_of "${all[@]}")" --scene "$1"
  keep picture_db "$(read -ra all <<<"${db[old]}"; middle_of "${all[@]}")" --scene "$1, old"
  keep picture_unused "$(read -ra all <<<"${idle[new]}"; middle_of "${all[@]}")" --scene "$1" --note "In the turns:${idle[new]} %."
  local pass
  for pass in "${picture_passes[@]}"; do
    case $pass in
      new-not-fitted) keep_difference picture_not_fitted "$1" new new-not-fitted ;;
      new-loaded) keep_difference picture_loaded "$1" new new-loaded ;;
      new-half) keep_difference "picture${picture_forms:+_forms}_half" "$1" new-half old-half "at the whole period, half of it here" ;;
    esac
  done
}

# each_scene GROUP FUNCTION: FUNCTION NAME SCENE PATH LIFT for each scene that was chosen, or for all. Makes the generated ones.
each_scene() {
  local name scene path lift chosen=" ${chosen_scenes[*]} "
  while read -r name scene path lift <&3; do
    [[ $chosen == "  " || $chosen == *" $name "* ]] || continue
    case $name in
      forest) picture_generate forest 10 "$old" || { failed=1; continue; } ;;
      town) picture_generate town 1 "$old" || { failed=1; continue; } ;;
      garden) picture_generate garden 1 "$new" || { failed=1; continue; } ;;
    esac
    "$2" "$name" "$scene" "$path" "$lift"
    chosen=${chosen/" $name "/" $name: done "}
  done 3< <(picture_sources)
  for name in "${chosen_scenes[@]}"; do
    if [[ $chosen != *" $name: done "* ]]; then echo "tests/bench/run: $1: there is no scene $name, or SUREFOOT_DATA names no folder" >&2; failed=1; fi
  done
}

picture_group() {
  local program
  for program in "$old/surefoot" "$new/surefoot" "$build/tests/bench_ledger_poses" "$build/tests/bench_picture_difference"; do
    [[ -x "$program" ]] || { echo "tests/bench/run: $program is not there: build it (the target benches has those of tests)" >&2; failed=1; return 0; }
  done
  picture_work=$work/picture picture_seconds=20 picture_rounds=3 picture_flat_frames=60
  if [[ -n "$picture_quick" ]]; then picture_seconds=5 picture_rounds=1 picture_flat_frames=9; fi
  picture_passes=(old new)
  [[ -z "$picture_not_fitted" ]] || picture_passes+=(new-not-fitted)
  [[ -z "$picture_half" ]] || picture_passes+=(old-half new-half)
  [[ -z "$picture_loaded" ]] || picture_passes+=(new-loaded)
  local -A db low similar late idle
  local full_ms full_before full_after picture_rate psnr worst ssim missed walked unused
  mkdir -p "$picture_work"
  picture_generate forest 10 "$old" || { failed=1; return 0; }
  # The forest first: it is what says how fast the machine is.
  picture_set_up "$old" forest "$picture_work/forest.glb" "$picture_work/forest.path.csv" 0 || { failed=1; return 0; }
  each_scene picture picture_scene
}
