/* SPDX-License-Identifier: MIT
 * Checkpoints: the next steps have the same bits, damage is found, the last two are kept. */
#include "output/checkpoint.h"
#include "geometry/scene_points.h"
#include "time/energy.h"
#include "fuzz.h"
#include "tiny.h"
#include "unity.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static struct diag diag;
static struct scene scene;
static struct simulation first, second;
static struct checkpoint image, other;
static char path[PATH_BYTES];

static void open_with(int n, const char *const *sets)
{
    diag = (struct diag){.code = ERR_OK};
    TEST_ASSERT_EQUAL_INT(ERR_OK, scene_load_text(&scene, tiny_case, "tiny.cfg", n, sets, &diag));
    TEST_ASSERT_EQUAL_INT(ERR_OK, simulation_create(&first, &scene, &diag));
    TEST_ASSERT_EQUAL_INT(ERR_OK, simulation_create(&second, &scene, &diag));
}

void setUp(void) {}

void tearDown(void)
{
    simulation_free(&first);
    simulation_free(&second);
    scene_free(&scene);
    checkpoint_free(&image);
    checkpoint_free(&other);
}

static void step(struct simulation *sim, int n)
{
    for (int k = 0; k < n; k++)
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, simulation_step(sim, 1.0, &diag), diag.text);
}

static void store(const char *folder, struct simulation *sim)
{
    mkdir(folder, 0777);
    TEST_ASSERT_EQUAL_INT(ERR_OK, checkpoint_capture(&image, sim, "the case", "1.2.3", &diag));
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, checkpoint_store(&image, folder, path, &diag), diag.text);
}

static void goes_on_with_the_same_bits(int n_sets, const char *const *sets)
{
    open_with(n_sets, sets);
    step(&first, 137);
    simulation_ledger(&first);
    store(tiny_path("bits"), &first);
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, checkpoint_read(&other, path, &diag), diag.text);
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, checkpoint_apply(&other, &second, &diag), diag.text);
    TEST_ASSERT_TRUE(simulation_hash(&first) == simulation_hash(&second));
    for (int k = 0; k < 100; k++) {
        step(&first, 1);
        step(&second, 1);
    }
    TEST_ASSERT_TRUE(first.state.time == second.state.time);
    TEST_ASSERT_TRUE(simulation_hash(&first) == simulation_hash(&second));
}

static void same_bits_symplectic(void) { goes_on_with_the_same_bits(0, NULL); }

static void same_bits_verlet(void)
{
    goes_on_with_the_same_bits(1, (const char *[]){"integrator=verlet"});
}

static void same_bits_double_single_rate(void)
{
    goes_on_with_the_same_bits(2, (const char *[]){"precision=double", "numerics.multirate=off"});
}

static uint64_t particles(const struct simulation *sim)
{
    uint64_t hash = HASH_START;
    for (int k = 0; k < KIND_COUNT; k++) hash = particles_hash(&sim->particles[k], hash);
    return hash;
}

/* A fork without a change, in the middle between two sorts: only energies are counted anew. */
static void an_unchanged_fork_keeps_the_bits(void)
{
    static const char *const sets[] = {"integrator=symplectic", "integrator=verlet",
                                       "integrator=leapfrog"};
    for (size_t k = 0; k < COUNT_OF(sets); k++) {
        open_with(1, &sets[k]);
        step(&first, 137);
        store(tiny_path("fork"), &first);
        const int64_t sorts = first.state.sorts;
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, checkpoint_read(&other, path, &diag), diag.text);
        TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, checkpoint_fork(&other, &second, &diag), diag.text);
        TEST_ASSERT_EQUAL_INT64(sorts, second.state.sorts);
        /* Its account of energy begins anew. */
        const struct ledger before = simulation_ledger(&first), now = simulation_ledger(&second);
        TEST_ASSERT_TRUE(fabs(before.dissipated) > 1e-6 * before.internal);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12 * fabs(now.potential), 0, now.dissipated);
        step(&first, 100);
        step(&second, 100);
        TEST_ASSERT_TRUE_MESSAGE(particles(&first) == particles(&second), sets[k]);
        tearDown();
    }
}

/* Another grid: cells of the checkpoint mean nothing there. */
static void a_fork_into_another_domain_is_sorted_again(void)
{
    static const char *const wider[] = {"domain.lower=-0.1, -0.1", "domain.upper=0.7, 0.5"};
    struct scene wide;
    open_with(0, NULL);
    step(&first, 20);
    store(tiny_path("wider"), &first);
    simulation_free(&second);
    TEST_ASSERT_EQUAL_INT(ERR_OK, scene_load_text(&wide, tiny_case, "x.cfg", 2, wider, &diag));
    TEST_ASSERT_EQUAL_INT(ERR_OK, simulation_create(&second, &wide, &diag));
    TEST_ASSERT_EQUAL_INT(ERR_OK, checkpoint_read(&other, path, &diag));
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, checkpoint_fork(&other, &second, &diag), diag.text);
    TEST_ASSERT_EQUAL_INT64(first.state.sorts + 1, second.state.sorts);
    step(&second, 20);
    simulation_free(&second);
    scene_free(&wide);
}

static void says_what_it_is(void)
{
    open_with(0, NULL);
    step(&first, 3);
    store(tiny_path("info"), &first);
    TEST_ASSERT_EQUAL_INT(ERR_OK, checkpoint_read(&other, path, &diag));
    const struct checkpoint_info info = checkpoint_info(&other);
    TEST_ASSERT_TRUE(info.time == first.state.time && info.steps == 3);
    TEST_ASSERT_TRUE(info.count[KIND_FLUID] == 100);
    TEST_ASSERT_EQUAL_STRING("the case", info.case_text);
    TEST_ASSERT_EQUAL_STRING("1.2.3", info.version);
}

/* Cells are numbers of a grid: those of another one are refused, whatever they name. */
static void cells_of_another_grid_are_refused(void)
{
    const int32_t wrong[] = {-2, 0, INT32_MAX};
    const char *const why[] = {"has no cell -2", "is too far from its cell 0",
                               "has no cell 2147483647"};
    for (int k = 0; k < 3; k++) {
        open_with(0, NULL);
        step(&first, 3);
        first.particles[KIND_FLUID].cell[99] = wrong[k];
        store(tiny_path("grid"), &first);
        TEST_ASSERT_EQUAL_INT(ERR_OK, checkpoint_read(&other, path, &diag));
        diag = (struct diag){0};
        TEST_ASSERT_EQUAL_INT(ERR_INPUT, checkpoint_apply(&other, &second, &diag));
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(diag.text, why[k]), diag.text);
        tearDown();
        setUp();
    }
}

/* Captures `first`, which holds a wrong number, and has it refused. */
static void refuses(const char *why)
{
    diag = (struct diag){.code = ERR_OK};
    TEST_ASSERT_EQUAL_INT(ERR_OK, checkpoint_capture(&image, &first, "the case", "1", &diag));
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_INPUT, checkpoint_apply(&image, &second, &diag), why);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(diag.text, why), diag.text);
}

#define REFUSES(member, value, why)                                     \
    do {                                                                \
        const __typeof__(first.state.member) kept = first.state.member; \
        first.state.member = (value);                                   \
        refuses(why);                                                   \
        first.state.member = kept;                                      \
    } while (0)

/* Checksums do not protect from a file that was made wrong. */
static void numbers_that_no_run_has_are_refused(void)
{
    open_with(0, NULL);
    step(&first, 3);
#define STATE(type, name, low, high, unit, meaning) \
    REFUSES(name, (type)((low) > -2 ? -3.0 : -2e300), #name " of run, item 0, is -");
#include "time/state.def"
#undef STATE
    REFUSES(solid_slowing, 0, "solid_slowing are invalid");
    REFUSES(solid_stiffening, 0, "solid_stiffening or solid_slowing are invalid");
    REFUSES(wall_work, (double)INFINITY,
            "wall_work of run, item 0, is inf, outside the valid range -1e+300 to 1e+300");
    REFUSES(energy_start, (double)NAN, "energy_start of run, item 0, is nan");
    REFUSES(steps, INT64_MAX, "steps of run, item 0, is 9.22337e+18");
    REFUSES(bound_steps[2], INT64_MAX - 1, "bound_steps of run, item 2, is ");
    REFUSES(energy.entry[1].supplied, (double)NAN, "energy of run, item ");
    first.particles[KIND_FLUID].ax[7] = (double)NAN;
    refuses("ax of fluid, item 7, is nan");
    first.particles[KIND_FLUID].ax[7] = 0;
    REFUSES(energy.entry[1].work_change, -1, "the account of energy");
    REFUSES(energy.entry[0].region, -2, "the account of energy");
    first.particles[KIND_SOLID].body[5] = 1;
    refuses("body of solid, item 5, is 1, outside the valid range 0 to 0");
    first.particles[KIND_SOLID].body[5] = -1;
    refuses("body of solid, item 5, is -1");
    first.particles[KIND_SOLID].body[5] = 0;
    TEST_ASSERT_EQUAL_INT(ERR_OK, checkpoint_capture(&image, &first, "the case", "1", &diag));
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, checkpoint_apply(&image, &second, &diag), diag.text);
}

static void missed_snapshots_are_counted_on(void)
{
    open_with(0, NULL);
    image.snapshots_missed = 7;
    TEST_ASSERT_EQUAL_INT(ERR_OK, checkpoint_capture(&image, &first, "the case", "1", &diag));
    image.snapshots_missed = -1;
    TEST_ASSERT_EQUAL_INT(ERR_OK, checkpoint_apply(&image, &second, &diag));
    TEST_ASSERT_EQUAL_INT64(7, image.snapshots_missed);
    image.snapshots_missed = -2;
    TEST_ASSERT_EQUAL_INT(ERR_OK, checkpoint_capture(&image, &first, "the case", "1", &diag));
    TEST_ASSERT_EQUAL_INT(ERR_INPUT, checkpoint_apply(&image, &second, &diag));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(diag.text, "snapshots_missed of run, item 0, is -2"),
                                 diag.text);
}

/* --- damage: two checkpoints of a small run, of which the newer one is damaged --- */

static int warnings;

static void count_warning(void *context, const char *text)
{
    (void)context;
    warnings += strstr(text, "step-000000003.ckpt: is not a valid checkpoint: ") != NULL ||
                strstr(text, "step-000000003.ckpt: has format") != NULL;
}

static void store_two(const char *folder)
{
    mkdir(folder, 0777);
    for (int steps = 0; steps <= 3; steps += 3) {
        snprintf(path, sizeof path, "%s/step-%09d.ckpt", folder, steps);
        TEST_ASSERT_EQUAL_INT(0, fuzz_write_checkpoint(path, steps));
    }
    diag = (struct diag){.code = ERR_OK, .warn = count_warning};
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, checkpoint_read(&image, path, &diag), diag.text);
}

/* With `n` bytes of the image in its place the newer one is found to be damaged, which is said, and
 * the one before it is used. */
static void the_one_before_is_used(const char *folder, size_t n, size_t at)
{
    char message[64], newer[PATH_BYTES];
    snprintf(message, sizeof message, "%zu bytes, damaged at %zu", n, at);
    snprintf(newer, sizeof newer, "%s/step-000000003.ckpt", folder);
    FILE *file = fopen(newer, "wb");
    TEST_ASSERT_EQUAL_INT(n, fwrite(image.bytes, 1, n, file));
    fclose(file);
    warnings = 0;
    TEST_ASSERT_EQUAL_INT_MESSAGE(ERR_OK, checkpoint_newest(&other, folder, path, &diag), message);
    TEST_ASSERT_EQUAL_INT_MESSAGE(1, warnings, message);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, checkpoint_info(&other).steps, message);
}

/* Through files a sample of bytes, because each costs a file; every byte is changed in memory
 * below. */
static void a_flipped_byte_in_a_file_is_found(void)
{
    const char *const folder = tiny_path("flip");
    size_t flipped = 0;
    store_two(folder);
    for (size_t k = 0; k < image.size; k += 13, flipped++) {
        image.bytes[k] ^= (unsigned char)(1 << k % 8);
        the_one_before_is_used(folder, image.size, k);
        image.bytes[k] ^= (unsigned char)(1 << k % 8);
    }
    printf("found: %zu bytes flipped\n", flipped);
}

/* In memory: one bit of every byte, and all changes of some. */
static void every_changed_byte_is_found(void)
{
    store_two(tiny_path("change"));
    for (size_t k = 0; k < image.size; k++) {
        const unsigned char was = image.bytes[k];
        const int some = k % 997 == 0, lowest = some ? 1 : 1 << k % 8;
        for (int c = lowest; c <= (some ? 255 : lowest); c++) {
            image.bytes[k] = was ^ (unsigned char)c;
            diag.code = ERR_OK;
            TEST_ASSERT_EQUAL_INT(ERR_IO, checkpoint_check(&image, "x.ckpt", &diag));
        }
        image.bytes[k] = was;
    }
    diag.code = ERR_OK;
    TEST_ASSERT_EQUAL_INT(ERR_OK, checkpoint_check(&image, "x.ckpt", &diag));
}

/* All lengths within the first kilobyte and near the end, and a sample of the others. */
static void a_cut_is_found(void)
{
    const char *const folder = tiny_path("cut");
    size_t cut = 0;
    store_two(folder);
    for (size_t n = 0; n < image.size; n += n < 1024 || n + 64 > image.size ? 1 : 13, cut++)
        the_one_before_is_used(folder, n, n);
    printf("found: %zu lengths cut\n", cut);
}

/* Too short for what every checkpoint has is told as that. */
static void a_short_file_is_told(void)
{
    open_with(0, NULL);
    store(tiny_path("short"), &first);
    const size_t whole = image.size;
    for (image.size = 0; image.size < 150; image.size++) {
        diag.code = ERR_OK;
        TEST_ASSERT_EQUAL_INT(ERR_IO, checkpoint_check(&image, "x.ckpt", &diag));
        TEST_ASSERT_EQUAL_STRING(
            "x.ckpt: is not a valid checkpoint: it is shorter than a header and a footer",
            diag.text);
    }
    image.size = whole;
}

/* The version of the program that wrote a checkpoint, as far as there is room. */
static void version_is_kept(void)
{
    open_with(0, NULL);
    char version[CHECKPOINT_VERSION_TEXT + 20];
    memset(version, 'v', sizeof version - 1);
    version[sizeof version - 1] = '\0';
    TEST_ASSERT_EQUAL_INT(ERR_OK, checkpoint_capture(&image, &first, "the case", version, &diag));
    const struct checkpoint_info info = checkpoint_info(&image);
    TEST_ASSERT_EQUAL_UINT64(sizeof info.version - 1, strlen(info.version));
    TEST_ASSERT_EQUAL_STRING("the case", info.case_text);
    /* A file made wrong: the text in its header does not end. */
    size_t at = 0;
    while (memcmp(image.bytes + at, "vvv", 3) != 0) at++;
    memset(image.bytes + at, 'w', sizeof info.version);
    const struct checkpoint_info wrong = checkpoint_info(&image);
    TEST_ASSERT_EQUAL_UINT64(sizeof wrong.version - 1, strlen(wrong.version));
}

static void bytes_behind_the_end_are_found(void)
{
    open_with(0, NULL);
    store(tiny_path("long"), &first);
    struct checkpoint longer = {.bytes = calloc(1, image.size + 8),
                                .size = image.size + 8,
                                .capacity = image.size + 8};
    memcpy(longer.bytes, image.bytes, image.size);
    TEST_ASSERT_EQUAL_INT(ERR_IO, checkpoint_check(&longer, "x.ckpt", &diag));
    checkpoint_free(&longer);
}

static int kept(const char *folder, const int *steps, int n)
{
    int found = 0;
    for (int k = 0; k < n; k++) {
        char name[PATH_BYTES];
        snprintf(name, sizeof name, "%s/step-%09d.ckpt", folder, steps[k]);
        found |= (access(name, F_OK) == 0) << k;
    }
    return found;
}

static void the_last_two_are_kept(void)
{
    open_with(0, NULL);
    for (int k = 0; k < 4; k++) {
        step(&first, 5);
        store(tiny_path("two"), &first);
    }
    TEST_ASSERT_EQUAL_HEX(0xc, kept(tiny_path("two"), (int[]){5, 10, 15, 20}, 4));
    TEST_ASSERT_EQUAL_INT(ERR_OK, checkpoint_remove_others(tiny_path("two"), 15, &diag));
    TEST_ASSERT_EQUAL_HEX(0x4, kept(tiny_path("two"), (int[]){5, 10, 15, 20}, 4));
}

static void an_empty_folder_has_none(void)
{
    open_with(0, NULL);
    mkdir(tiny_path("empty"), 0777);
    TEST_ASSERT_EQUAL_INT(ERR_IO, checkpoint_newest(&other, tiny_path("empty"), path, &diag));
    TEST_ASSERT_NOT_NULL(strstr(diag.text, "empty"));
}

/* A sound file of another case: every count is compared before anything is copied. */
static void another_case_is_refused(void)
{
    struct checkpoint larger = {0};
    open_with(1, (const char *[]){"dp=5mm"});
    TEST_ASSERT_EQUAL_INT(ERR_OK, checkpoint_capture(&larger, &first, "", "", &diag));
    tearDown();
    open_with(0, NULL);
    TEST_ASSERT_EQUAL_INT(ERR_INPUT, checkpoint_apply(&larger, &second, &diag));
    TEST_ASSERT_NOT_NULL(strstr(diag.text, "particles"));
    checkpoint_free(&larger);
}

int main(void)
{
    /* In memory where that is possible: thousands of files are written. */
    if (!getenv("TMPDIR") && access("/dev/shm", W_OK) == 0) setenv("TMPDIR", "/dev/shm", 0);
    UNITY_BEGIN();
    RUN_TEST(same_bits_symplectic);
    RUN_TEST(same_bits_verlet);
    RUN_TEST(same_bits_double_single_rate);
    RUN_TEST(an_unchanged_fork_keeps_the_bits);
    RUN_TEST(a_fork_into_another_domain_is_sorted_again);
    RUN_TEST(says_what_it_is);
    RUN_TEST(cells_of_another_grid_are_refused);
    RUN_TEST(numbers_that_no_run_has_are_refused);
    RUN_TEST(missed_snapshots_are_counted_on);
    RUN_TEST(a_flipped_byte_in_a_file_is_found);
    RUN_TEST(every_changed_byte_is_found);
    RUN_TEST(a_cut_is_found);
    RUN_TEST(a_short_file_is_told);
    RUN_TEST(version_is_kept);
    RUN_TEST(bytes_behind_the_end_are_found);
    RUN_TEST(the_last_two_are_kept);
    RUN_TEST(an_empty_folder_has_none);
    RUN_TEST(another_case_is_refused);
    return UNITY_END();
}
