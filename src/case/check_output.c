/* SPDX-License-Identifier: MIT
 * The fields in the snapshots of a case. */
#include "case/case.h"

#include <string.h>

static const char blanks[] = " \t,";

enum err case_check_output(struct reader *r)
{
    static const char *const names[] = {
#define POINTDATA(NAME, name, item, width, choice) #name,
#include "case/pointdata.def"
#undef POINTDATA
    };
    const struct scene_output *const out = &r->scene->output;
    if (strcmp(out->snapshot_fields, "all") == 0) return ERR_OK;
    const char *at = out->snapshot_fields;
    for (size_t n; *(at += strspn(at, blanks)); at += n) {
        struct nearest near = {0};
        char word[SCENE_NAME] = "";
        bool known = false;
        n = strcspn(at, blanks);
        memcpy(word, at, n < sizeof word ? n : sizeof word - 1);
        for (size_t k = 0; k < COUNT_OF(names); k++) {
            known |= strcmp(names[k], word) == 0;
            nearest_offer(&near, word, names[k]);
        }
        if (!known)
            return bad_line(
                r, out->common.line,
                "[output] snapshot_fields: there is no field `%s`%s%s%s Allowed: all, or any of"
#define POINTDATA(NAME, name, item, width, choice) " " #name
#include "case/pointdata.def"
#undef POINTDATA
                ,
                word, near.name ? "; did you mean `" : ".", near.name ? near.name : "",
                near.name ? "`?" : "");
    }
    return ERR_OK;
}
