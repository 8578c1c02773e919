# What every script test is made of, read with `. tests/rig/result.bash` from the project's root: one line a case, and in the end
# `exit $((failures > 0))`.
failures=0

result() { # STATUS WHAT: "ok - WHAT" for status 0, or "not ok - WHAT" and status 1
    if [ "$1" = 0 ]; then echo "ok - $2"; return 0; fi
    echo "not ok - $2"
    failures=$((failures + 1))
    return 1
}

wait_for() { # FILE PATTERN: until a line of a program in the background matches, 20 s at most
    for _ in $(seq 400); do
        grep -q "$2" "$1" 2>/dev/null && return 0
        sleep 0.05
    done
    return 1
}
