/* SPDX-License-Identifier: MIT
 * Tiles: the candidates of the nine cells around a cell, copied together so that full vectors can be loaded
 * from them. A part of the sweeps' text (fluid_sweep.h), once for each precision. */

#define TILE_FAR 1000 /* in units of h; the kernel ends at 2 */

/* Candidates of one kind of particles, padded at the end with particles far away and without volume.
 * A copy may write up to LANES beyond the last. */
struct SWEEP(tile) {
    int n; /* a multiple of LANES */
    int fields;
    real field[][TILE_CAPACITY * 2 + 2 * LANES] __attribute__((aligned(64)));
};

static struct SWEEP(tile) * thread_tile(const struct fluid *f, int which)
{
    const size_t place = (size_t)(2 * thread_index() + which) * f->tile_size;
    return (struct SWEEP(tile) *)(void *)((char *)f->tiles + place);
}

/* Appends the particles of one cell, whose centre lies (dx, dy) from the tile's, in units of h; with more
 * fields than the common ones, or not. */
SPHFSI_INLINE int tile_append(struct SWEEP(tile) * tile, int n, const struct lanes *lanes,
                              int32_t start, int32_t count, real dx, real dy, bool more)
{
    const vreal shift_x = vset(dx), shift_y = vset(dy);
    for (int32_t k = 0; k < count; k += LANES) {
        vstore(&tile->field[LANE_X][n + k],
               vload((const real *)lanes->field[LANE_X] + start + k) + shift_x);
        vstore(&tile->field[LANE_Y][n + k],
               vload((const real *)lanes->field[LANE_Y] + start + k) + shift_y);
        for (int m = LANE_U; m < LANE_FIELDS; m++)
            vstore(&tile->field[m][n + k], vload((const real *)lanes->field[m] + start + k));
    }
    for (int m = LANE_FIELDS; more && m < lanes->n; m++)
        for (int32_t k = 0; k < count; k += LANES)
            vstore(&tile->field[m][n + k], vload((const real *)lanes->field[m] + start + k));
    return n + count;
}

/* Appends the nine cells around `cell` of one kind; returns the number of candidates so far. */
static int tile_gather(struct SWEEP(tile) * tile, int n, const struct fluid *f,
                       const struct cells *c, enum kind kind, int32_t cell)
{
    const struct cell_list *list = &c->kind[kind];
    const int cx = cell_x(c, cell), cy = cell_y(c, cell);
    const double side_x = c->side[0] / f->k.h, side_y = c->side[1] / f->k.h;
    const bool more = f->lanes[kind].n > LANE_FIELDS;
    const int column[3] = {cells_place(c, 0, cx - 1), cx, cells_place(c, 0, cx + 1)};
    for (int dy = -1; dy <= 1; dy++) {
        const int row = cells_place(c, 1, cy + dy);
        if (row < 0) continue;
        for (int dx = -1; dx <= 1; dx++) {
            if (column[dx + 1] < 0) continue;
            const int32_t other = row * c->nx + column[dx + 1];
            if (list->count[other] == 0) continue;
            n = tile_append(tile, n, &f->lanes[kind], list->start[other], list->count[other],
                            (real)(dx * side_x), (real)(dy * side_y), more);
        }
    }
    return n;
}

static void tile_close(struct SWEEP(tile) * tile, int n)
{
    const int padded = (n + LANES - 1) / LANES * LANES;
    for (; n < padded; n++) {
        for (int m = 0; m < LANE_FIELDS; m++) tile->field[m][n] = 0;
        for (int m = LANE_FIELDS; m < tile->fields; m++) tile->field[m][n] = 0;
        tile->field[LANE_X][n] = TILE_FAR;
    }
    tile->n = padded;
}

/* Corners of the candidates of a tile, in its coordinates. */
struct SWEEP(box) {
    real low[2], high[2];
};

static struct SWEEP(box) box_of_tile(const struct SWEEP(tile) * tile, int n)
{
    struct SWEEP(box) box = {{TILE_FAR, TILE_FAR}, {-TILE_FAR, -TILE_FAR}};
    for (int k = 0; k < n; k++) {
        const real place[2] = {tile->field[LANE_X][k], tile->field[LANE_Y][k]};
        for (int axis = 0; axis < 2; axis++) {
            box.low[axis] = place[axis] < box.low[axis] ? place[axis] : box.low[axis];
            box.high[axis] = place[axis] > box.high[axis] ? place[axis] : box.high[axis];
        }
    }
    return box;
}

/* Whether all candidates are further away than the kernel reaches, with a margin for rounding: every sum
 * over them is zero. */
static bool out_of_reach(const struct SWEEP(box) * box, real x, real y)
{
    const double dx = max2(0, max2(box->low[0] - x, x - box->high[0]));
    const double dy = max2(0, max2(box->low[1] - y, y - box->high[1]));
    return dx * dx + dy * dy > square(1.001 * KERNEL_REACH);
}
