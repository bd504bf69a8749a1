# The group `forms OLD NEW` of tests/bench/run, which sources this: forms of named things before and after, on one page, and the closest
# pictures of their coarse forms as one JPEG. Each build bakes for itself; its own `inspect --pictures` draws.
# shellcheck shell=bash
# shellcheck disable=SC2034,SC2154 # work, old, new, failed: of run

# SCENE NODE WORDS, a line a thing.
forms_things() {
  cat <<'THINGS'
forest birch a birch
forest spruce a spruce
forest grass a tuft of grass
garden fern a fern
garden left a fence
garden rose a rose
cocoa palm a palm
candela Lamp a street lamp
candela cypress a cypress
ravenbridge pumpkin a pumpkin
THINGS
}

# The first card of a page of forms that is none of a cluster: what is between its own line and the next.
forms_card() { # PAGE
  awk '/^<div class="card node">/ { if (open) exit; if ($0 !~ /<h3>cluster/) open = 1 } /^<h2>|^<footer>/ { if (open) exit } open' "$1"
}

# The close pictures of a card, as JPEG files AT-0.jpg, AT-1.jpg and so on, coarse to fine.
forms_pictures() { # CARD AT
  local i=0 data
  while read -r data; do
    base64 -d <<<"$data" >"$2-$i.jpg"
    i=$((i + 1))
  done < <(grep -o '<img src="data:image/jpeg;base64,[^"]*" alt="[^"]*close"' "$1" |
    sed 's/.*base64,//; s/" alt.*//')
  echo "$i"
}

# Page and pictures of one thing by both builds. Appends to WORK/forms/index.html.
forms_thing() { # SCENE NODE WORDS
  local at=$work/forms side build page count rows=()
  for side in old new; do
    build=$new
    [[ $side != old ]] || build=$old
    page=$at/$1-$2-$side
    if ! "$build/surefoot" inspect "$at/$1-$side.walk" --pictures "$page" --node "$2" --nodes 3 --state "$at/state" >"$page.log" 2>&1; then
      echo "tests/bench/run: forms: $1 $2, $side: $(tail -n 1 "$page.log")" >&2
      return 1
    fi
    forms_card "$page/index.html" >"$page/card.html"
    count=$(forms_pictures "$page/card.html" "$page/form")
    (( count > 0 )) || { echo "tests/bench/run: forms: $1 $2, $side: no form is drawn" >&2; return 1; }
    rows+=("$page" "$count")
  done
  { echo "<h2>$1: $3</h2><h3>before</h3>"; cat "${rows[0]}/card.html"; echo "<h3>after</h3>"; cat "${rows[2]}/card.html"; } >>"$at/body.html"
  # Four coarse forms and full detail of each side, in one strip.
  local strip=() i
  for side in 0 2; do
    for (( i = 0; i < 4; ++i )); do
      if (( i < rows[side + 1] - 1 )); then strip+=("${rows[side]}/form-$i.jpg"); else strip+=(xc:white); fi
    done
    strip+=("${rows[side]}/form-$((rows[side + 1] - 1)).jpg")
  done
  convert "${strip[@]}" -resize 128x128 -background white -gravity center -extent 132x132 +append -font DejaVu-Sans -pointsize 13 -gravity northwest \
    -annotate +3+1 "$3" "$at/strip-$(printf %02d "$forms_row").png" || return 1
  (( ++forms_row ))
}

forms_group() {
  local at=$work/forms scene node words forms_row=10 side build path lift input picture_work=$work/picture made=' '
  command -v convert >/dev/null || { echo "tests/bench/run: forms wants convert (Debian: imagemagick)" >&2; failed=1; return 0; }
  mkdir -p "$at/state" "$picture_work"
  rm -f "$at"/strip-*.png "$at/body.html" "$at"/*.walk
  while read -r scene node words <&4; do
    if [[ $made != *" $scene "* ]]; then
      made+="$scene "
      chosen_scenes=("$scene")
      each_scene forms forms_bake
    fi
    [[ -f "$at/$scene-new.walk" ]] || continue
    forms_thing "$scene" "$node" "$words" || failed=1
  done 4< <(forms_things)
  { echo "<!doctype html><html lang=en><meta charset=utf-8><title>Forms before and after</title>"
    sed -n '/<style>/,/<\/style>/p' "$(ls -d "$at"/*-new/index.html | head -n 1)"
    echo "<body><h1>Forms before and after</h1>"; cat "$at/body.html"; } >"$at/index.html"
  convert -size 1320x24 xc:white -font DejaVu-Sans -pointsize 15 -annotate +3+17 "before: coarse to fine, and full detail" \
    -annotate +663+17 "after" "$at/strip-00.png"
  convert "$at"/strip-*.png -append -fill black -draw "line 659,0 659,2000" -quality 80 "$at/forms.jpg"
  echo "tests/bench/run: $at/index.html and $at/forms.jpg: five pictures before, five after; the fifth is full detail" >&2
}

forms_bake() { # NAME SCENE PATH LIFT
  local side build
  for side in old new; do
    build=$new
    [[ $side != old ]] || build=$old
    [[ -f "$work/forms/$1-$side.walk" ]] ||
      measure "forms bake $side $1" "$build/surefoot" bake "$2" -o "$work/forms/$1-$side.walk" --state "$work/forms/state" --json || { failed=1; return 0; }
  done
}
