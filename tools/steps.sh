# Steps with headings, the time they took, and quiet output. Sourced by ./demo, ./test and .ci/run, in the root.
#
#   step 'Heading' command...     runs it; its output goes to a log, whose tail is shown when it fails
#   loud_step 'Heading' command...  the same with its output shown

log_folder=build/logs
mkdir -p "$log_folder"
began_all=$SECONDS

heading() { printf '== %s\n' "$1"; }

finish() {
  local status=$1 began=$2
  if ((status == 0)); then printf '   done in %d s\n' $((SECONDS - began)); else printf '   FAILED after %d s\n' $((SECONDS - began)); fi
}

step() {
  local title=$1 log status=0 began=$SECONDS
  shift
  log="$log_folder/$(tr -c 'A-Za-z0-9\n' '-' <<<"${title%% (*}").log"
  heading "$title"
  "$@" >"$log" 2>&1 || status=$?
  finish "$status" "$began"
  ((status == 0)) && return
  printf '\nThe end of its log, %s:\n\n' "$log"
  tail -n 40 "$log"
  exit 1
}

loud_step() {
  local title=$1 status=0 began=$SECONDS
  shift
  heading "$title"
  "$@" || status=$?
  finish "$status" "$began"
  ((status == 0)) || exit 1
}
