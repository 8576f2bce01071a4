/* SPDX-License-Identifier: MIT
 * Tiles: the candidates of the cells around a cell or a strip of cells, column by column, copied together so
 * that full vectors can be loaded from them. A part of the sweeps' text (fluid_sweep.h), once for each
 * precision. */

#define TILE_FAR 1000 /* in units of h; the kernel ends at 2 */

/* Candidates of one kind of particles, padded at the end with particles far away and without volume.
 * A copy may write up to LANES beyond the last. */
struct SWEEP(tile) {
    int n; /* a multiple of LANES */
    int fields;
    real field[][TILE_CAPACITY * 2 + 2 * LANES] __attribute__((aligned(64)));
};

/* Candidates of a tile, from the first to before the end. What fills up the last pack is out of reach, or
 * belongs to the next cell: `used` is 1 in the lanes that count, so that what is taken over all candidates
 * (the bound of Eq. 28b) does not depend on how many lanes there are. */
struct SWEEP(range) {
    int first, end;
    vreal used;
};

static struct SWEEP(range) range_of(int first, int end)
{
    static const real used[2 * LANES] = {[0 ... LANES - 1] = 1};
    const int last = end > first ? (end - first - 1) % LANES + 1 : 0;
    return (struct SWEEP(range)){first, end, vload(&used[LANES - last])};
}

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

/* The cell whose centre is a tile's, and the sides of all cells in units of h. */
struct SWEEP(place) {
    int cx, cy;
    real side_x, side_y;
};

static struct SWEEP(place) place_of(const struct fluid *f, const struct cells *c, int32_t cell)
{
    return (struct SWEEP(place)){cell_x(c, cell), cell_y(c, cell), (real)(c->side[0] / f->k.h),
                                 (real)(c->side[1] / f->k.h)};
}

/* Appends the three cells of one kind dx columns beside a tile's; returns the number of candidates so far. */
static int tile_column(struct SWEEP(tile) * tile, int n, const struct fluid *f,
                       const struct cells *c, enum kind kind, const struct SWEEP(place) * place,
                       int dx)
{
    const struct cell_list *list = &c->kind[kind];
    const int column = cells_place(c, 0, place->cx + dx);
    if (column < 0) return n;
    for (int dy = -1; dy <= 1; dy++) {
        const int row = cells_place(c, 1, place->cy + dy);
        if (row < 0) continue;
        const int32_t cell = row * c->nx + column;
        if (list->count[cell] > 0)
            n = tile_append(tile, n, &f->lanes[kind], list->start[cell], list->count[cell],
                            (real)dx * place->side_x, (real)dy * place->side_y,
                            f->lanes[kind].n > LANE_FIELDS);
    }
    return n;
}

/* Ends a tile after n candidates with lanes that are far away and without volume. */
static void tile_close(struct SWEEP(tile) * tile, int n)
{
    for (int m = 0; m < tile->fields; m++) vstore(&tile->field[m][n], vset(0));
    vstore(&tile->field[LANE_X][n], vset(TILE_FAR));
    tile->n = (n + LANES - 1) / LANES * LANES;
}

/* Fills a tile with the nine cells around `cell` of one kind; returns the number of candidates. */
static int tile_around(struct SWEEP(tile) * tile, const struct fluid *f, const struct cells *c,
                       enum kind kind, int32_t cell)
{
    const struct SWEEP(place) place = place_of(f, c, cell);
    int n = 0;
    for (int dx = -1; dx <= 1; dx++) n = tile_column(tile, n, f, c, kind, &place, dx);
    tile_close(tile, n);
    return n;
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
