/* SPDX-License-Identifier: MIT */
#include "app/plot_hint.h"

#include "app/shell.h"

#include "base/files.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Cuts the last `names` names off a path; false: it has fewer. */
static bool cut_names(char *path, int names)
{
    for (; names > 0; names--) {
        char *const slash = strrchr(path, '/');
        if (!slash) return false;
        *slash = '\0';
    }
    return true;
}

/* The clone that the program lies in, at its top or in a folder of build/, with a slash behind it; nothing
 * where that is the working directory. */
static bool find_clone(char root[PATH_BYTES])
{
    static const char tool[] = "/tools/plot_probes.py";
    char program[PATH_BYTES], path[PATH_BYTES + sizeof tool], here[PATH_BYTES];
    const ssize_t n = readlink("/proc/self/exe", program, sizeof program - 1);
    if (n <= 0) return false;
    program[n] = '\0';
    for (int up = 1; up <= 2; up++) { /* its folder, then two above that */
        if (!cut_names(program, up)) return false;
        snprintf(path, sizeof path, "%s%s", program, tool);
        if (access(path, R_OK) != 0) continue;
        const bool top = getcwd(here, sizeof here) && strcmp(here, program) == 0;
        snprintf(root, PATH_BYTES, "%.*s%s", PATH_BYTES - 2, top ? "" : program, top ? "" : "/");
        return true;
    }
    return false;
}

/* The Python that tools/setup.sh has found; false: none that can be run. */
static bool find_python(const char *root, char python[PATH_BYTES])
{
    char path[PATH_BYTES], *text;
    size_t size;
    if (snprintf(path, sizeof path, "%sbuild/python", root) >= PATH_BYTES) return false;
    if (access(path, R_OK) != 0 || file_read(path, &text, &size, NULL)) return false;
    snprintf(python, PATH_BYTES, "%.*s", (int)strcspn(text, "\n"), text);
    free(text);
    return python[0] && (!strchr(python, '/') || access(python, X_OK) == 0);
}

void say_plot_hint(const char *folder, const struct sphfsi_options *o)
{
    char root[PATH_BYTES], python[PATH_BYTES], path[PATH_BYTES + 32], found[QUOTED_BYTES];
    char run[QUOTED_BYTES], tool[QUOTED_BYTES], setup[QUOTED_BYTES];
    shell_quote(run, folder);
    if (!find_clone(root)) {
        session_say(o, "plot it with: python3 -m sphfsi plot %s  # needs the Python package", run);
        return;
    }
    snprintf(path, sizeof path, "%stools/plot_probes.py", root);
    shell_quote(tool, path);
    if (find_python(root, python)) {
        shell_quote(setup, python);
        session_say(o, "plot it with: %s %s %s", setup, tool, run);
        return;
    }
    snprintf(path, sizeof path, "%stools/setup.sh", root);
    shell_quote(setup, path);
    snprintf(path, sizeof path, "%sbuild/python", root);
    shell_quote(found, path);
    session_say(o, "plot it with: %s plot && \"$(cat %s)\" %s %s", setup, found, tool, run);
}
