/* SPDX-License-Identifier: Apache-2.0 */
#include "bar/search_plan.h"

/* Lines are numbered from the border at the plan's pitch. Each level takes one residue class; all
 * classes together take every line once. */
#define LEVELS SEARCH_LEVELS
static const int modulus[LEVELS] = {16, 16, 8, 4, 2};
static const int residue[LEVELS] = {8, 0, 4, 2, 1};

void search_plan_init(search_plan_t *plan, int width, int height, int pitch)
{
    const search_plan_t fresh = {width, height, pitch, 0, 0, 0};
    *plan = fresh;
}

int search_plan_next(search_plan_t *plan, search_line_t *line)
{
    while (plan->level < LEVELS) {
        const int size = plan->upright ? plan->width : plan->height;
        const int number = residue[plan->level] + plan->next * modulus[plan->level];
        const int at = number * plan->pitch + plan->pitch / 2;
        if (at < size || (number == 0 && size > 0)) {
            ++plan->next;
            line->upright = plan->upright;
            line->at = at < size ? at : size - 1;
            line->from = 0;
            line->to = (plan->upright ? plan->height : plan->width) - 1;
            return 1;
        }
        plan->next = 0;
        plan->level += plan->upright;
        plan->upright = !plan->upright;
    }
    return 0;
}
