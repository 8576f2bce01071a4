#!/bin/sh
# Writes a C file that holds text files as strings, by their names: tools/embed.sh OUT.c FILE...
# Needs a POSIX shell and sed only, those of the machine that builds.
set -eu
out=$1
shift
{
    echo '/* Written by tools/embed.sh from the files named below. */'
    echo '#include "app/embedded.h"'
    echo 'const struct embedded_file embedded_files[] = {'
    for file; do
        stem=${file##*/}
        printf '{"%s", "%s",\n' "$file" "${stem%.*}"
        sed 's/[\\"]/\\&/g; s/^/"/; s/$/\\n"/' "$file"
        echo '},'
    done
    echo '{0, 0, 0}};'
} >"$out.new"
mv "$out.new" "$out"
