#!/bin/sh
# Runs a command on a virtual display of its own. Exit status 77, "skipped", if Xvfb is not installed.
# Xvfb chooses a free display number and reports it when it is ready, so any number of these may run at once.
if ! command -v Xvfb >/dev/null; then
    echo "skipped: Xvfb is not installed (Debian's package xvfb)"
    exit 77
fi
folder=$(mktemp -d) || exit 1
mkfifo "$folder/display"
Xvfb -displayfd 3 -screen 0 1280x1024x24 -noreset -nolisten tcp 3>"$folder/display" 2>"$folder/errors" &
server=$!
trap 'kill "$server" 2>/dev/null; wait "$server" 2>/dev/null; rm -rf "$folder"' EXIT
trap 'exit 143' TERM INT
read -r number <"$folder/display" || { echo "Xvfb did not start:"; cat "$folder/errors"; exit 1; }
# evoview's recent servers are stored in the folder of the test.
DISPLAY=:$number XDG_STATE_HOME=$folder/state "$@"
