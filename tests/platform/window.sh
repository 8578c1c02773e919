#!/bin/bash
# The window of the emulator on a virtual display: GL ES 1.1 and desktop GL by GLFW draw the same picture (tests/terrain/test_surface.c).
set -u
cd "$(dirname "$0")/../.." || exit 2
test=${BUILD:-build}/tests/test_surface
if ! command -v xvfb-run >/dev/null; then echo "ok - # skip no xvfb-run"; exit 0; fi
if [ ! -x "$test" ]; then echo "not ok - $test is not built"; exit 1; fi
if CMOCKA_MESSAGE_OUTPUT=TAP xvfb-run -a "$test" | tee "${BUILD:-build}/tests/window.log" |
    grep -q '^ok .*windows_show_the_same_on_both_kinds_of_gl$'; then
    echo "ok - windows draw on a virtual display"
else
    cat "${BUILD:-build}/tests/window.log"
    echo "not ok - windows draw on a virtual display"
    exit 1
fi
