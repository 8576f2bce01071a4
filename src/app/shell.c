/* SPDX-License-Identifier: MIT */
#include "app/shell.h"

#include <string.h>

void shell_quote(char out[QUOTED_BYTES], const char *text)
{
    static const char plain[] =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./=+,";
    size_t n = 0;
    if (text[0] && strspn(text, plain) == strlen(text)) {
        snprintf(out, QUOTED_BYTES, "%s", text);
        return;
    }
    out[n++] = '\'';
    for (; *text && n < QUOTED_BYTES - 6; text++)
        if (*text == '\'')
            n += (size_t)snprintf(out + n, QUOTED_BYTES - n, "'\\''");
        else
            out[n++] = *text;
    out[n++] = '\'';
    out[n] = '\0';
}
