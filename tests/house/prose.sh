#!/usr/bin/env bash
# The documents read at the first reading: sentences are short, lines fit, and every page, file and name of code is there.
# usage: prose.sh SOURCE_DIR
# Read are README.md, ARCHITECTURE.md, CONTRIBUTING.md, CHANGELOG.md and every page beside the code. Not read: RESULTS.md.
# README.md has at most 110 lines and ARCHITECTURE.md at most 130. No source and no page refers to what is outside of the repository.
#   mean sentence of a page    at most 15 words
#   any sentence               at most 30 words
#   a line                     at most 160 characters
# A heading and a fenced block hold no sentences. A list item, and a cell of a table, ends a sentence. A cell of up to three
# words is a label and does not count. Code in backticks is one word.
# What a page names must be there:
#   a page or a path           in the tree
#   name.cpp, name.hpp         the end of a file's path; in backticks and in fenced blocks
#   a name, Name::name, f()    each part stands in the sources, outside of comments; in fenced blocks only what is called
#   Suite.Case, Suite.*        a test
set -u
export LC_ALL=C

max_mean=15 max_words=30 max_line=160
declare -A max_lines=([README.md]=110 [ARCHITECTURE.md]=130)
# Pages of plans and of findings, and their numbered items.
outside='DESIGN|[a-z]+\.md F?[0-9]|research[ /]|\bR[0-9]+\b'

# Names that pages may use and no source has: samples, a family of GL, and what is not built.
exceptions="snake_case PascalCase bench_NAME glMultiDrawElementsIndirect reactive greedy oracle"

# Prints problems as FILE:LINE: WHAT, then one line "page FILE MEAN LONGEST LINE" for each page. For what a page names:
# "name FILE:LINE NAME" (a page or path), "file FILE:LINE NAME" (a source), "word FILE:LINE NAME" (a name of code).
read -r -d '' reader <<'AWK' || true
function characters(text) { gsub(/[\200-\277]/, "", text); return length(text) }

function name_sources(text,    name) {
  while (match(text, /[A-Za-z0-9_.\/-]+\.[ch]pp/)) {
    name = substr(text, RSTART, RLENGTH)
    if (name !~ /[A-Z]/) print "file " FILENAME ":" FNR " " name  # NAME_test.cpp stands for many
    text = substr(text, RSTART + RLENGTH)
  }
}

function name_calls(text) {
  while (match(text, /[A-Za-z_][A-Za-z0-9_]*\(/)) {
    print "word " FILENAME ":" FNR " " substr(text, RSTART, RLENGTH) ")"
    text = substr(text, RSTART + RLENGTH)
  }
}

# Links and pictures become their text; code becomes one word.
function plain(text,    out, inner) {
  while (match(text, /!?\[[^]]*\]\([^)]*\)/)) {
    inner = substr(text, RSTART, RLENGTH)
    out = inner
    sub(/^!?\[/, "", out); sub(/\]\([^)]*\)$/, "", out)
    sub(/^.*\]\(/, "", inner); sub(/\)$/, "", inner); sub(/#.*$/, "", inner)
    if (inner != "" && inner !~ /^[a-z]+:/) print "name " FILENAME ":" FNR " " inner
    text = substr(text, 1, RSTART - 1) out substr(text, RSTART + RLENGTH)
  }
  while (match(text, /`[^`]+`/)) {
    inner = substr(text, RSTART + 1, RLENGTH - 2)
    if (inner ~ /^(rt|render|input|config|systemd|tools|tests)\/[A-Za-z0-9_.\/-]+$/ || inner ~ /^[A-Za-z0-9_.\/-]+\.md$/)
      print "name " FILENAME ":" FNR " " inner
    else if (inner !~ /\.[ch]pp$/ && inner ~ /^[A-Za-z_][A-Za-z0-9_]*((::|\.)[A-Za-z_][A-Za-z0-9_]*)*(\(\)|\.\*)?$/)
      print "word " FILENAME ":" FNR " " inner
    out = substr(text, 1, RSTART - 1) "code" substr(text, RSTART + RLENGTH)
    name_sources(inner)
    text = out
  }
  return text
}

function end_sentence() {
  if (words > 0) {
    sentences++
    all += words
    if (words > longest) { longest = words; longest_at = began }
    if (words > max_words) print FILENAME ":" began ": a sentence of " words " words: " start " ..."
  }
  words = 0
  start = ""
}

function take(text,    list, n, i, word) {
  n = split(text, list, /[ \t]+/)
  for (i = 1; i <= n; i++) {
    word = list[i]
    if (word ~ /[A-Za-z0-9\200-\377]/) {
      if (words == 0) began = FNR
      words++
      if (words <= 6) start = start (words > 1 ? " " : "") word
    }
    if (word ~ /[.!?]["')*_]*$/ && word !~ /^[("]*(e\.g|i\.e|cf|vs|al|Fig|fig|Sec|No)\.$/) end_sentence()
  }
}

function take_row(text,    cells, n, i) {
  end_sentence()
  if (text ~ /^[ \t]*\|[-: |]+$/) return
  gsub(/\\\|/, "/", text)
  n = split(text, cells, /\|/)
  for (i = 1; i <= n; i++) {
    if (split(cells[i], unused, /[ \t]+/) > 0 && count_words(cells[i]) > 3) take(cells[i])
    end_sentence()
  }
}

function count_words(text,    list, n, i, count) {
  n = split(text, list, /[ \t]+/)
  for (i = 1; i <= n; i++) count += list[i] ~ /[A-Za-z0-9\200-\377]/ ? 1 : 0
  return count + 0
}

FNR == 1 { fenced = 0; words = 0; sentences = 0; all = 0; longest = 0; longest_at = 1 }
{
  length_here = characters($0)
  if (length_here > max_line) print FILENAME ":" FNR ": a line of " length_here " characters"
  if ($0 ~ /^[ \t]*(```|~~~)/) { end_sentence(); fenced = !fenced; next }
  if (fenced) { name_sources($0); name_calls($0); next }
  if ($0 ~ /DESIGN|shared\//) print FILENAME ":" FNR ": names what is not in the repository"
  text = plain($0)
  if (text ~ /^[ \t]*$/ || text ~ /^#/ || text ~ /^(---|===)/ || text ~ /^[ \t]*<[^>]*>[ \t]*$/) { end_sentence(); next }
  if (text ~ /^[ \t]*\|/) { take_row(text); next }
  if (text ~ /^[ \t]*([-*+]|[0-9]+[.)])[ \t]/) { end_sentence(); sub(/^[ \t]*([-*+]|[0-9]+[.)])[ \t]+/, "", text) }
  sub(/^[ \t]*>[ \t]?/, "", text)
  take(text)
}
END {
  end_sentence()
  mean = sentences > 0 ? all / sentences : 0
  if (mean > max_mean) printf "%s:1: %.1f words a sentence in the mean\n", FILENAME, mean
  printf "page %s %.1f %d %d\n", FILENAME, mean, longest, longest_at
}
AWK

# There as named, from the page's folder or from the top; a name without an ending stands for the files that begin so.
is_there() {
  local page=$1 name=$2
  [[ -e "$(dirname "$page")/$name" || -e "$name" ]] || compgen -G "$name.*" >/dev/null
}

sources() { git ls-files --cached --others --exclude-standard 2>/dev/null || find . -type f ! -path './build*' -printf '%P\n'; }

# Every name in the sources, outside of comments that begin with two slashes; what is called as NAME( too; tests as Suite.Case and
# Suite.*.
source_words() {
  local list
  list=$(sources | grep -vE '\.(md|csv|png|svg|glb|walk)$|^tests/house/(banned_names(_test\.cpp|\.hpp)|prose\.sh)$')
  xargs -d '\n' sed -E 's#(^|[[:space:]])//.*##' <<<"$list" 2>/dev/null |
    grep -aoE '[A-Za-z_][A-Za-z0-9_]*(<[A-Za-z0-9_:, ]*>)?\(?' | sed -E 's/<.*>//; s/^(\w+)\($/\1\n\1(/'
  grep -E '_test\.cpp$' <<<"$list" | xargs -r -d '\n' cat | tr '\n' ' ' | grep -oE 'TEST(_[FP])?\([A-Za-z0-9_]+, *[A-Za-z0-9_]+\)' |
    sed -E 's/.*\((\w+), *(\w+)\)/\1.\2\n\1.*/'
}

declare -A files words
read_sources() {
  local name
  files=() words=()
  while IFS= read -r name; do
    files[$name]=1
    while [[ $name == */* ]]; do name=${name#*/} files[$name]=1; done
  done < <(sources)
  while IFS= read -r name; do words[$name]=1; done < <(source_words | sort -u; tr ' ' '\n' <<<"$exceptions")
}

is_known() { # NAME of code
  local name=${1%"()"} part
  [[ -v "files[$name]" ]] && return 0
  if [[ $1 == *"()" && ! -v "words[${name##*[:.]}(]" ]]; then return 1; fi
  if [[ $name =~ ^[A-Z][A-Za-z0-9]*\.([A-Z][A-Za-z0-9]*|\*)$ ]]; then
    [[ -v "words[$name]" ]]
    return
  fi
  for part in ${name//[:.]/ }; do [[ -v "words[$part]" ]] || return 1; done
}

# check_pages PAGE...: prints what is wrong and a line for each page; fails where something is wrong. After read_sources.
check_pages() {
  local page line place name mean longest problems=0
  for page in "$@"; do
    while IFS= read -r line; do
      case $line in
        "page "*)
          read -r _ _ mean longest place <<<"$line"
          printf '%-28s mean %4s words, longest %2s at %s:%s\n' "$page" "$mean" "$longest" "$page" "$place"
          ;;
        "name "*)
          place=${line#name } name=${place#* } place=${place%% *}
          is_there "$page" "$name" && continue
          echo "$place: names $name, which is not there"
          problems=$((problems + 1))
          ;;
        "file "* | "word "*)
          place=${line#* } name=${place#* } place=${place%% *}
          if [[ $line == file* ]]; then [[ -v "files[$name]" ]] && continue; else is_known "$name" && continue; fi
          echo "$place: names $name, which no source has"
          problems=$((problems + 1))
          ;;
        *) echo "$line"; problems=$((problems + 1)) ;;
      esac
    done < <(awk -v max_mean=$max_mean -v max_words=$max_words -v max_line=$max_line "$reader" "$page")
  done
  (( problems == 0 ))
}

# has_length PAGE: fails where it has more lines than it may.
has_length() {
  local lines
  lines=$(wc -l <"$1")
  (( lines <= max_lines[$1] )) && return 0
  echo "$1: $lines lines, at most ${max_lines[$1]}"
  return 1
}

# stays_inside: fails where a source or a page below this folder refers to what is outside of it.
stays_inside() {
  ! grep -rnE "$outside" --include='*.hpp' --include='*.cpp' --include='*.md' --exclude-dir='build*' --exclude-dir='.git' .
}

# The check itself: a good sample passes, and each bad one fails for its own reason.
check_itself() {
  local folder
  folder=$(mktemp -d) || return 1
  trap 'rm -rf "$folder"' RETURN
  local good="A page says one thing. It is short (see \`code with spaces\`)."
  local after_sign="One sentence of eighteen words that ends after a sign is told from the next one in 99 %.
The next one, of about as many words, would make too many words of both if they were one."
  local thirty_one="" dull="" i
  for i in {1..31}; do thirty_one+="word "; done
  for i in {1..18}; do dull+="word "; done
  (
    cd "$folder" || exit 1
    mkdir room
    printf '// gone\nTEST(Suite,\n     Case) { there::also(1); }\n' >room/code_test.cpp
    read_sources
    # good: a fence, a table, a link to itself and a name that is there may hold anything
    printf '# %s\n%s\n%s\n\n| a | %s |\n|---|---|\n| b | c |\n\n```\n%s.\ncode_test.cpp: also()\n```\n- [it](good.md) `good.md`\n' \
      "$thirty_one" "$good" "$after_sign" "$good" "$thirty_one" >good.md
    printf -- '- `%s`\n' code_test.cpp room/code_test.cpp there 'also()' there::also Suite.Case 'Suite.*' NAME_test.cpp >>good.md
    check_pages good.md >good.log || { echo "a good page is refused:"; cat good.log; exit 1; }
    refused() { # NAME TEXT WHAT
      printf '%s\n' "$2" >"$1.md"
      if check_pages "$1.md" >"$1.log"; then echo "not refused: $1"; exit 1; fi
      grep -q "$3" "$1.log" || { echo "$1 is refused for another reason:"; cat "$1.log"; exit 1; }
    }
    refused long_sentence "$good $thirty_one." "a sentence of 31 words"
    refused long_over_lines "${thirty_one:0:80}
${thirty_one:80}." "a sentence of 31 words"
    refused long_cell "| $thirty_one | b |" "a sentence of 31 words"
    refused long_item "- $thirty_one" "a sentence of 31 words"
    refused dull "$dull. $dull." "in the mean"
    refused long_line "$(printf 'x%.0s' {1..161})" "a line of 161 characters"
    refused dead_link "[a page](nowhere.md)" "nowhere.md, which is not there"
    refused dead_page "See \`nowhere.md\`." "nowhere.md, which is not there"
    refused dead_file "See \`render/nowhere/no.hpp\`." "no.hpp, which is not there"
    refused dead_source "See \`no.cpp\`." "no.cpp, which no source has"
    refused dead_source_of_folder "See \`hall/code_test.cpp\`." "which no source has"
    refused dead_source_in_words "See \`no.hpp: also()\`." "no.hpp, which no source has"
    refused dead_source_in_fence "$(printf '```\nno.cpp\n```')" "no.cpp, which no source has"
    refused dead_call_in_fence "$(printf '```\nno()\n```')" "no(), which no source has"
    refused dead_name "It is \`gone\`." "gone, which no source has"
    refused dead_call "It is \`there()\`." "there(), which no source has"
    refused dead_member "It is \`there::no()\`." "no(), which no source has"
    refused dead_case "See \`Suite.Also\`." "Suite.Also, which no source has"
    refused dead_suite "See \`Also.*\`." "which no source has"
    refused outside "As DESIGN says." "not in the repository"
    wide=$(printf 'µ%.0s' {1..160})
    printf '%s\n' "$wide" >wide.md
    check_pages wide.md >wide.log || { echo "160 wide characters are refused:"; cat wide.log; exit 1; }
    seq 110 >README.md
    has_length README.md || { echo "110 lines are refused"; exit 1; }
    seq 111 >README.md
    has_length README.md >/dev/null && { echo "not refused: 111 lines"; exit 1; }
    mkdir inside && cd inside || exit 1
    printf '// An answer (Maciel 1994, section 3.4), and RGB8.\n' >good.hpp
    stays_inside || { echo "a source that stays inside is refused"; exit 1; }
    for reference in 'See plan.md 4.' 'See audit.md F12.' 'As research/peers has it.' 'Finding R7.'; do
      printf '// %s\n' "$reference" >bad.cpp
      stays_inside >/dev/null && { echo "not refused: $reference"; exit 1; }
    done
    exit 0
  )
}

cd "${1:?SOURCE_DIR}" || exit 1
check_itself || exit 1
read_sources
for page in README.md ARCHITECTURE.md CONTRIBUTING.md CHANGELOG.md; do
  [[ -f "$page" ]] || { echo "$page is not there"; exit 1; }
done
mapfile -t pages < <(
  printf '%s\n' README.md ARCHITECTURE.md CONTRIBUTING.md CHANGELOG.md
  find rt render input config systemd tools tests -name '*.md' ! -path tests/bench/RESULTS.md | sort
)
check_pages "${pages[@]}" || exit 1
has_length README.md && has_length ARCHITECTURE.md || exit 1
stays_inside || exit 1
echo "${#pages[@]} pages"
