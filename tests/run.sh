#!/bin/bash
# Builds and runs every test and counts the cases. Last line: "N passed, N failed".
#   run.sh           sanitized build: unit tests (test_*.c), fuzz targets over their saved inputs (tests/corpus), scripts
#   run.sh --quick   tests already built in $BUILD: unit tests and tests/project/checks.sh
#   run.sh --only PATTERN   suites whose name matches the shell pattern
# JOBS suites run side by side (default: one per processor); SUITE_TIMEOUT_S stops one that hangs.
# A case is a line "ok ..." or "not ok ..." (TAP); skips count as neither. A suite that crashes, hangs or has no case is a failure.
set -u
cd "$(dirname "$0")/.." || exit 2
: "${BUILD:=build/san}" "${JOBS:=$(nproc)}" "${SUITE_TIMEOUT_S:=600}"
logs=$BUILD/test-logs
mkdir -p build/tests "$logs"

# Runs suite KIND:NAME, leaves its output and counts in $logs and prints one line of progress.
run_suite() {
    local kind=${1%%:*} name=${1#*:} log=$logs/${1#*:} rc start=$SECONDS
    local -a command
    case $kind in
        unit) command=("$BUILD/tests/$name") ;;
        fuzz) command=("$BUILD/tests/$name-replay" "tests/corpus/${name#fuzz_}"/*) ;;
        script) command=(tests/*/"$name.sh") ;;
    esac
    timeout --kill-after=10 "$SUITE_TIMEOUT_S" "${command[@]}" >"$log.log" 2>&1 </dev/null
    rc=$?
    count_suite "$kind" "$name" "$rc" "$((SECONDS - start))"
}

count_suite() {
    local kind=$1 name=$2 rc=$3 seconds=$4 log=$logs/$2.log passed failed skipped word=ok why=""
    skipped=$(grep -a -c -i -E '^((not )?ok .*# skip|skip\b)' "$log")
    passed=$(grep -a -v -i '# skip' "$log" | grep -a -c '^ok\b')
    failed=$(grep -a -v -i '# skip' "$log" | grep -a -c '^not ok\b')
    if [ "$kind" = fuzz ] && [ "$rc" = 0 ] && [ "$passed" = 0 ]; then passed=1; fi
    if [ "$rc" != 0 ] && [ "$failed" = 0 ]; then failed=1; why=" (exit $rc)"; fi
    [ "$rc" = 124 ] && why=" (stopped after $SUITE_TIMEOUT_S s)"
    if [ "$((passed + failed + skipped))" = 0 ]; then failed=1; why=" (no case)"; fi
    [ "$failed" = 0 ] || word=FAIL
    [ "$skipped" = 0 ] || why="$why, $skipped skipped"
    echo "$passed $failed" >"$logs/$name.count"
    printf '%-5s%-28s %4d cases %4d s%s\n' "$word" "$name" "$((passed + failed))" "$seconds" "$why"
}

# Builds both flavours; a failed build is a failed case, and what could be built still runs.
build_all() {
    local rc=0 make=${MAKE:-make}
    echo "building, normal and sanitized (log: $logs/build.log)"
    {
        "$make" -k -j"$JOBS" all && "$make" -k -j"$JOBS" SAN=1 all test-build
    } >"$logs/build.log" 2>&1 || { rc=$?; "$make" -k -j"$JOBS" SAN=1 all test-build >>"$logs/build.log" 2>&1; }
    [ "$rc" != 0 ] || echo "ok - build" >>"$logs/build.log"
    count_suite build build "$rc" "$SECONDS"
}

list_suites() {
    local file quick=$1
    for file in tests/*/test_*.c; do [ -e "$file" ] && echo "unit:$(basename "$file" .c)"; done
    if [ "$quick" = 1 ]; then echo script:checks; return; fi
    for file in tests/*/fuzz_*.c; do [ -e "$file" ] && echo "fuzz:$(basename "$file" .c)"; done
    for file in tests/*/*.sh; do echo "script:$(basename "$file" .sh)"; done
}

show_failures() {
    local count passed failed name
    for count in "$logs"/*.count; do
        read -r passed failed <"$count"
        [ "$failed" != 0 ] || continue
        name=$(basename "$count" .count)
        echo "---- $name: last lines of $logs/$name.log ----"
        grep -a -v '^ok\b' "$logs/$name.log" | tail -n 60
    done
}

sum_up() {
    local count passed failed all_passed=0 all_failed=0
    for count in "$logs"/*.count; do
        read -r passed failed <"$count"
        all_passed=$((all_passed + passed))
        all_failed=$((all_failed + failed))
    done
    show_failures
    echo "$all_passed passed, $all_failed failed"
    [ "$all_failed" = 0 ] && [ "$all_passed" != 0 ]
}

main() {
    local quick=0 only='*'
    unset MAKEFLAGS MFLAGS MAKELEVEL # the flavour and the jobs of the make that called do not concern the ones called here
    case ${1:-} in
        --quick) quick=1 ;;
        --only) only=${2:?run.sh: --only needs a pattern} ;;
        --suite) run_suite "$2"; return 0 ;;
        "") ;;
        *) echo "run.sh: unknown option $1" >&2; return 2 ;;
    esac
    rm -rf "$logs"
    mkdir -p "$logs"
    [ "$quick" = 1 ] || build_all
    export BUILD SUITE_TIMEOUT_S
    export BIN=${BIN:-$BUILD/bin} CMOCKA_MESSAGE_OUTPUT=TAP
    export LSAN_OPTIONS="suppressions=$PWD/tests/lsan.supp:print_suppressions=0${LSAN_OPTIONS:+:$LSAN_OPTIONS}"
    [ -e tests/lsan.supp ] || unset LSAN_OPTIONS
    list_suites "$quick" | while read -r suite; do
        # shellcheck disable=SC2053
        [[ ${suite#*:} == $only ]] && echo "$suite"
    done | xargs -r -P "$JOBS" -n 1 "$0" --suite
    sum_up
}

main "$@"; exit $? # on one line: an edit of this file meanwhile changes nothing
