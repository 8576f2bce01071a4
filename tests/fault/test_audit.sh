#!/usr/bin/env bash
# What a run touches, by the system's own account (strace): nothing is made, written, renamed or
# removed outside of its folder, no other program is started, no connection is opened. And a clock
# that steps back, wall time and monotonic, by a library in front of the C library's.
. tests/support/shell.sh
case=$(realpath tests/fault/tiny.cfg)
calls=0
export OMP_NUM_THREADS=2

"$sphfsi" "$case" --quiet --out "$dir/whole" >"$dir/output" 2>&1 || fail "the run itself"

# --- the clock ---
if cc -shared -fPIC -O1 -x c -o "$dir/clock.so" - 2>"$dir/output" <<'END'; then
#include <stddef.h>
#include <sys/time.h>
#include <time.h>
static long calls;
int clock_gettime(clockid_t id, struct timespec *t)
{
    calls++;
    /* Wall time: an hour back at every call. Monotonic: on by a minute, back by a day at times. */
    t->tv_sec = id == CLOCK_REALTIME ? 1000000000 - 3600 * calls
                                     : 1000000 + 60 * calls - 86400 * (calls / 37);
    t->tv_nsec = 0;
    return 0;
}
time_t time(time_t *t)
{
    const time_t now = 1000000000 - 3600 * ++calls;
    if (t) *t = now;
    return now;
}
int gettimeofday(struct timeval *t, void *zone)
{
    (void)zone;
    t->tv_sec = 1000000000 - 3600 * ++calls;
    t->tv_usec = 0;
    return 0;
}
END
    # A sanitizer's runtime wants to come first.
    if LD_PRELOAD=$dir/clock.so "$sphfsi" --version >/dev/null 2>&1; then
        LD_PRELOAD=$dir/clock.so timeout 60 "$sphfsi" "$case" --quiet --out "$dir/clock" \
            --set output.checkpoint_minutes=5 >"$dir/output" 2>&1 ||
                fail "clock stepping back: status $?"
        [ "$(hash "$dir/clock")" = "$(hash "$dir/whole")" ] ||
            fail "clock stepping back: other bits"
        cmp "$dir/clock/probes.csv" "$dir/whole/probes.csv" ||
            fail "clock stepping back: probes.csv"
        # Five minutes are five looks at this clock: the cadence goes on behind a step back.
        [ "$(ls "$dir"/clock/step-*.ckpt | wc -l)" = 2 ] ||
            fail "clock stepping back: no checkpoints"
        clock="one run with its clocks stepping back"
    fi
fi

# --- what is touched ---
if ! strace -f -o "$dir/probe" true 2>/dev/null; then
    echo "strace is not there"
    [ $failures = 0 ] && exit 77
    exit 1
fi

watched=open,openat,creat,mkdir,mkdirat,rename,renameat,renameat2,unlink,unlinkat,link,linkat
watched+=,symlink,symlinkat,truncate,chmod,fchmodat,chown,fchownat,mknod,mknodat
watched+=,execve,execveat,vfork,fork,socket,connect

# audit NAME ARGUMENTS...: the folder is $dir/NAME.
audit() {
    local name=$1
    shift
    mkdir -p "$dir/at"
    (cd "$dir/at" && strace -f -qq -s 4096 -o "$dir/$name.trace" \
        -e trace="$watched" \
        "$sphfsi" "$@" --quiet) >"$dir/output" 2>&1
    "${PYTHON:-python3}" "$dir/judge.py" "$dir/$name.trace" "$dir/$name" "$dir/at" >"$dir/found" ||
        fail "$name: $(head -n 5 "$dir/found")"
    calls=$((calls + $(sed -n 's/^calls //p' "$dir/found")))
}

cat >"$dir/judge.py" <<'END'
import os, re, sys
trace, folder, here = sys.argv[1:]
bad = n = programs = 0
for line in open(trace, errors="replace"):
    call = re.match(r"(?:\d+ +)?(\w+)\((.*)", line)
    if not call or " ENOENT " in line and "O_CREAT" not in line:
        continue
    name, rest = call.groups()
    if name == "execve":
        programs += 1
    if name in ("open", "openat") and not re.search(r"O_WRONLY|O_RDWR|O_CREAT|O_TRUNC", rest):
        continue
    paths = [] if name in ("execve", "socket") else re.findall(r'"((?:[^"\\]|\\.)*)"', rest)
    n += 1
    for path in paths:
        whole = os.path.normpath(os.path.join(here, path))
        # Folders above the run's are made if they are not there, and the OpenMP runtime may ask.
        if whole == folder or whole.startswith(folder + "/") or "EEXIST" in line:
            continue
        bad += 1
        print(f"{name} {whole}: {line.strip()[:200]}")
    if name in ("fork", "vfork", "execveat", "socket", "connect"):
        bad += 1
        print(f"another program or a connection: {line.strip()[:200]}")
if programs != 1:
    bad += 1
    print(f"{programs} programs")
print(f"calls {n}")
sys.exit(bad > 0)
END

audit run "$case" --out "$dir/run" --until 0.01 --set output.checkpoint_interval=2ms
audit run "$case" --out "../run" --restart
audit fork "$case" --out "$dir/fork" --fork "$dir/run" --until 0.022 --set gate.young=2e6
# A refusal, --inspect and --explain write nothing at all.
audit nothing "$case" --out "$dir/run"
audit nothing "$case" --explain
audit nothing --inspect "$(ls "$dir"/run/step-*.ckpt | head -n 1)"
audit run "$case" --out "$dir/run" --restart --set gate.young=5
[ ! -e "$dir/nothing" ] || fail "something was written by a run that was refused"
[ -z "$(ls "$dir/at")" ] || fail "something was written where the program was started"
# A title that would be a command.
sed 's/^title.*/title = "$(touch pwned); `touch pwned` | touch pwned"/' "$case" >"$dir/title.cfg"
audit title "$dir/title.cfg" --out "$dir/title"
[ ! -e "$dir/at/pwned" ] || fail "a shell was called with a title"

echo "found: $calls calls that make, write, rename or remove, all within the folder of the run;" \
    "${clock:-no run with another clock}; $failures failures"
[ $failures = 0 ] || exit 1
