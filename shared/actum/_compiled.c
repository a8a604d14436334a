/* The steps that run for every frame, compiled: the same operations in the same order as the NumPy code beside which
   each is called. Arrays are C-contiguous; who calls has checked their shapes. */

#define PY_SSIZE_T_CLEAN
#define Py_LIMITED_API 0x030b0000
#include <Python.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#if defined(__x86_64__) && defined(__gnu_linux__) && defined(__GNUC__) && !defined(__clang__)
#define VECTORISED __attribute__((target_clones("avx2", "default"))) /* the processor's own width, chosen at run time */
#define FUSED __attribute__((target("avx2,fma")))
#define HAS_FUSED (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
#else
#define VECTORISED
#define FUSED
#ifdef __aarch64__
#define HAS_FUSED 1
#else
#define HAS_FUSED 0
#endif
#endif
#ifndef SOURCE
#define SOURCE ""
#endif
#define INLINE static inline __attribute__((always_inline))

enum { SIDES = 2, JOINTS = 15, COORDINATES = 45, PARTS = 5, LIMBS = 4, MOMENTS = 8, MOST_INSTANTS = 64, LANES = 8, BLOCK = 32,
       MOST_SIGNED = 4096,
       TOTALS = PARTS + LIMBS * MOMENTS + 3, BODY = 4 * COORDINATES + 16 };

/* Release the buffers that were taken, and return None, or NULL where an error is set. */
static PyObject *released(Py_buffer *buffers, int count)
{
    while (count-- > 0)
        PyBuffer_Release(&buffers[count]);
    if (PyErr_Occurred())
        return NULL;
    Py_RETURN_NONE;
}

/* Whether each of some buffers has at least so many bytes; sets an error where one has not. */
static int are_long_enough(const Py_buffer *buffers, const size_t *bytes, int count)
{
    for (int n = 0; n < count; n++)
        if ((size_t)buffers[n].len < bytes[n]) {
            PyErr_SetString(PyExc_ValueError, "an array is shorter than the compiled step needs");
            return 0;
        }
    return 1;
}

/* Prefix sums of a segment of so many frames: a row of sums before, between and after its frames, of which some units
   are another side's and skipped, and the distances travelled until then. */
typedef struct {
    const uint32_t *const *rows;
    const int64_t *travelled_um;
    Py_ssize_t frames, skipped;
} Segment;

/* The instants, as fractional frame numbers, at which a segment reaches the progress asked for: np.interp of rising
   `reached`, which is half time and half way. */
static double instant_of(double progress, const Segment *segment, double begin, double moved)
{
    Py_ssize_t frames = segment->frames;
    double per_frame = moved > 0 ? 0.5 / (double)frames : 1.0 / (double)frames, per_um = moved > 0 ? 0.5 / moved : 0.0;
    Py_ssize_t low = 0, high = frames;
#define REACHED(k) (per_frame * (double)(k) + per_um * ((double)segment->travelled_um[k] - begin))
    if (progress >= REACHED(frames))
        return (double)frames;
    if (progress < REACHED(0))
        return 0.0;
    while (high - low > 1) {
        Py_ssize_t middle = (low + high) / 2;
        if (progress >= REACHED(middle))
            low = middle;
        else
            high = middle;
    }
    double before = REACHED(low);
    return 1.0 / (REACHED(low + 1) - before) * (progress - before) + (double)low;
#undef REACHED
}

/* A pyramid: its borders, and at which of them each cell begins and ends. */
typedef struct {
    const double *borders;
    const int32_t *begins, *ends;
    Py_ssize_t count, cells;
    double scale;
} Cells;

/* Where a border lies: before which frame, and by which share of that frame after it. */
typedef struct {
    double at;
    float share;
    Py_ssize_t row;
} Place;

/* Sums at a border since the segment's start. Those of a few frames are converted as signed numbers, which is faster. */
INLINE void sum_at_border(const uint32_t *start, const uint32_t *below, const uint32_t *above, float share, int few,
                          float *out, Py_ssize_t units)
{
    for (Py_ssize_t u = 0; u < units; u++) {
        uint32_t first = below[u] - start[u], second = above[u] - start[u];
        float before = few ? (float)(int32_t)first : (float)first, after = few ? (float)(int32_t)second : (float)second;
        out[u] = before + (after - before) * share;
    }
}

/* Write the fourth roots of the cells' means by the sums at all borders, for which there is room. */
INLINE void pool_at(const Segment *segment, const Cells *cells, const Place *places, Py_ssize_t units, int few,
                    float *at_border, float *out)
{
    for (Py_ssize_t k = 0; k < cells->count; k++) {
        const uint32_t *const *at = segment->rows + places[k].row;
        sum_at_border(segment->rows[0] + segment->skipped, at[0] + segment->skipped, at[1] + segment->skipped,
                      places[k].share, few, at_border + k * units, units);
    }
    for (Py_ssize_t c = 0; c < cells->cells; c++) {
        const float *begin = at_border + cells->begins[c] * units, *end = at_border + cells->ends[c] * units;
        float length = (float)((places[cells->ends[c]].at - places[cells->begins[c]].at) * cells->scale);
        for (Py_ssize_t u = 0; u < units; u++)
            out[c * units + u] = sqrtf(sqrtf((end[u] - begin[u]) / length));
    }
}

VECTORISED static void pool_few(const Segment *segment, const Cells *cells, const Place *places, Py_ssize_t units,
                                float *at_border, float *out)
{
    pool_at(segment, cells, places, units, 1, at_border, out);
}

VECTORISED static void pool_many(const Segment *segment, const Cells *cells, const Place *places, Py_ssize_t units,
                                 float *at_border, float *out)
{
    pool_at(segment, cells, places, units, 0, at_border, out);
}

/* Write the fourth root of each cell's mean activity, cells * units; `places` and `at_border` are room for borders. */
static void pool(const Segment *segment, const Cells *cells, Py_ssize_t units, Place *places, float *at_border, float *out)
{
    double begin = (double)segment->travelled_um[0], moved = (double)segment->travelled_um[segment->frames] - begin;
    for (Py_ssize_t k = 0; k < cells->count; k++) {
        double at = instant_of(cells->borders[k], segment, begin, moved);
        Py_ssize_t row = (Py_ssize_t)at < segment->frames ? (Py_ssize_t)at : segment->frames - 1;
        places[k] = (Place){at, (float)(at - (double)row), row};
    }
    (segment->frames < MOST_SIGNED ? pool_few : pool_many)(segment, cells, places, units, at_border, out);
}

/* Room for what pooling needs: rows and distances of so many frames, and the borders of a pyramid. */
typedef struct {
    const uint32_t **rows;
    const int64_t **totals;
    int64_t *travelled_um;
    Place *places;
    float *at_border;
} Room;

static void leave(Room *room)
{
    PyMem_Free(room->rows);
    PyMem_Free(room->totals);
    PyMem_Free(room->travelled_um);
    PyMem_Free(room->places);
    PyMem_Free(room->at_border);
}

/* Take room; sets an error where there is none. */
static Room room_for(Py_ssize_t frames, Py_ssize_t borders, Py_ssize_t units)
{
    Room room = {PyMem_Malloc((frames + 1) * sizeof *room.rows),         PyMem_Malloc((frames + 1) * sizeof *room.totals),
                 PyMem_Malloc((frames + 1) * sizeof *room.travelled_um), PyMem_Malloc(borders * sizeof *room.places + 1),
                 PyMem_Malloc(borders * units * sizeof(float) + 1)};
    if (room.rows == NULL || room.totals == NULL || room.travelled_um == NULL || room.places == NULL || room.at_border == NULL)
        PyErr_NoMemory();
    return room;
}

/* Pool a span of frames, from the first up to the one before `after`. */
static void pool_span(const Room *room, const Cells *cells, Py_ssize_t first, Py_ssize_t after, Py_ssize_t skipped,
                      Py_ssize_t units, float *out)
{
    Segment segment = {room->rows + first, room->travelled_um + first, after - first, skipped};
    pool(&segment, cells, units, room->places, room->at_border, out);
}

PyDoc_STRVAR(pooled_doc,
    "pooled(sums, travelled_um, spans, borders, begins, ends, scale, out)\n--\n\n"
    "Write the fourth root of each cell's mean activity, (spans, cells * units), of spans of frames of a run, of which\n"
    "there are the prefix sums: the first frame of each, and the one after its last.");
static PyObject *pooled(PyObject *module, PyObject *args)
{
    Py_buffer b[7];
    double scale;
    if (!PyArg_ParseTuple(args, "y*y*y*y*y*y*dw*", &b[0], &b[1], &b[2], &b[3], &b[4], &b[5], &scale, &b[6]))
        return NULL;
    Cells cells = {b[3].buf, b[4].buf, b[5].buf, b[3].len / 8, b[4].len / 4, scale};
    const int64_t *spans = b[2].buf;
    Py_ssize_t frames = b[1].len / 8 - 1, count = b[2].len / 16, units = frames >= 0 ? b[0].len / 4 / (frames + 1) : 0;
    int fits = cells.cells > 0 && units > 0 && b[6].len == count * cells.cells * units * (Py_ssize_t)sizeof(float);
    for (Py_ssize_t n = 0; n < count && fits; n++)
        fits = spans[2 * n] >= 0 && spans[2 * n] < spans[2 * n + 1] && spans[2 * n + 1] <= frames;
    Room room = room_for(fits ? frames : 0, cells.count, units);
    if (!fits)
        PyErr_SetString(PyExc_ValueError, "a span holds no frame or reaches beyond the sums, or the result has another size");
    if (!PyErr_Occurred()) {
        Py_BEGIN_ALLOW_THREADS
        memcpy(room.travelled_um, b[1].buf, (frames + 1) * sizeof *room.travelled_um);
        for (Py_ssize_t k = 0; k <= frames; k++)
            room.rows[k] = (const uint32_t *)b[0].buf + k * units;
        for (Py_ssize_t n = 0; n < count; n++)
            pool_span(&room, &cells, spans[2 * n], spans[2 * n + 1], 0, units, (float *)b[6].buf + n * cells.cells * units);
        Py_END_ALLOW_THREADS
    }
    leave(&room);
    return released(b, 7);
}

/* Each limb's spread (mm) over the frames between two sums of moments. */
static void spreads_between(const int64_t *before, const int64_t *after, double *of)
{
    for (int limb = 0; limb < LIMBS; limb++, before += MOMENTS, after += MOMENTS) {
        int64_t count = after[MOMENTS - 1] - before[MOMENTS - 1], squares = after[MOMENTS - 2] - before[MOMENTS - 2];
        double means2 = 0.0, variance;
        for (int i = 0; i < MOMENTS - 2; i++) {
            double sum = (double)(after[i] - before[i]);
            means2 += sum * sum;
        }
        variance = count ? (double)squares / (double)count - means2 / ((double)count * (double)count) : 0.0;
        of[limb] = variance > 0.0 ? sqrt(variance) : 0.0;
    }
}

/* Whether of all limbs the left arm moves most over the frames between two sums of moments, and clearly more than the right. */
static int left_arm_moves_most(const int64_t *before, const int64_t *after, double jitter_mm, double factor)
{
    enum { RIGHT_ARM, LEFT_ARM };
    double of[LIMBS], most;
    spreads_between(before, after, of);
    most = of[0];
    for (int limb = 1; limb < LIMBS; limb++)
        most = of[limb] > most ? of[limb] : most;
    return most == of[LEFT_ARM] && most + jitter_mm > factor * (of[RIGHT_ARM] + jitter_mm);
}

/* Find the rows before row k + 1 of a run, which must be there, and add them; -1 where an error is set. */
static int add_rows(Room *room, Py_ssize_t k, const Py_buffer *sums, const Py_buffer *totals, Py_ssize_t row, Py_ssize_t units)
{
    size_t rows = (size_t)row + 1;
    if (row < 0 || (size_t)sums->len < rows * SIDES * units * sizeof(uint32_t)
        || (size_t)totals->len < rows * TOTALS * sizeof(int64_t)) {
        PyErr_SetString(PyExc_ValueError, "a run of frames lacks the sums of one of them");
        return -1;
    }
    room->rows[k] = (const uint32_t *)sums->buf + row * SIDES * units;
    room->totals[k] = (const int64_t *)totals->buf + row * TOTALS;
    room->travelled_um[k] = 0;
    for (int part = 0; part < PARTS; part++)
        room->travelled_um[k] += room->totals[k][part];
    return 0;
}

/* Find the memory of an array of a run, which keeps it; -1 where an error is set. */
static int take_array(PyObject *run, Py_ssize_t number, Py_buffer *array)
{
    PyObject *item = PyTuple_GetItem(run, number);
    if (item == NULL || PyObject_GetBuffer(item, array, PyBUF_SIMPLE) < 0)
        return -1;
    PyBuffer_Release(array);
    return 0;
}

/* Find the sums before, between and after frames by their activities: a run, and the row before the frame. The list
   keeps the runs, so their buffers need not be held. -1 where an error is set. */
static int find_rows(Room *room, PyObject *activities, Py_ssize_t units)
{
    PyObject *run = NULL;
    Py_buffer sums, totals;
    for (Py_ssize_t k = 0; k < PyList_Size(activities); k++) {
        PyObject *activity = PyList_GetItem(activities, k), *next = PyTuple_GetItem(activity, 0);
        PyObject *before = next == NULL ? NULL : PyTuple_GetItem(activity, 1);
        Py_ssize_t row = before == NULL ? -1 : PyLong_AsSsize_t(before);
        if (PyErr_Occurred())
            return -1;
        if (next != run && (take_array(next, 0, &sums) < 0 || take_array(next, 1, &totals) < 0))
            return -1;
        run = next;
        if ((k == 0 && add_rows(room, 0, &sums, &totals, row, units) < 0)
            || add_rows(room, k + 1, &sums, &totals, row + 1, units) < 0)
            return -1;
    }
    return 0;
}

PyDoc_STRVAR(pooled_windows_doc,
    "pooled_windows(activities, firsts, mirrors, jitter_mm, factor, borders, begins, ends, scale, out)\n--\n\n"
    "Write the same for several windows, (windows, cells * units), that end with the last of the frames' activities, as\n"
    "seen or, where the mirror image may be read and the left arm acts, mirrored.");
static PyObject *pooled_windows(PyObject *module, PyObject *args)
{
    PyObject *activities, *firsts;
    Py_buffer b[4];
    int mirrors;
    double jitter_mm, factor, scale;
    if (!PyArg_ParseTuple(args, "O!O!pddy*y*y*dw*", &PyList_Type, &activities, &PyList_Type, &firsts, &mirrors, &jitter_mm,
                          &factor, &b[0], &b[1], &b[2], &scale, &b[3]))
        return NULL;
    Cells cells = {b[0].buf, b[1].buf, b[2].buf, b[0].len / 8, b[1].len / 4, scale};
    Py_ssize_t windows = PyList_Size(firsts), frames = PyList_Size(activities);
    Py_ssize_t row = windows ? b[3].len / (Py_ssize_t)sizeof(float) / windows : 0, units = cells.cells ? row / cells.cells : 0;
    Room room = room_for(frames, cells.count, units);
    if (!PyErr_Occurred() && units < 1)
        PyErr_SetString(PyExc_ValueError, "there is no window, or the pyramid has no cell");
    int found = !PyErr_Occurred() && find_rows(&room, activities, units) == 0;
    for (Py_ssize_t w = 0; w < windows && found; w++) {
        Py_ssize_t first = PyLong_AsSsize_t(PyList_GetItem(firsts, w));
        if (!PyErr_Occurred() && (first < 0 || first >= frames))
            PyErr_SetString(PyExc_ValueError, "a window holds no frame");
        if (PyErr_Occurred())
            break;
        int side = mirrors && left_arm_moves_most(room.totals[first] + PARTS, room.totals[frames] + PARTS, jitter_mm, factor);
        pool_span(&room, &cells, first, frames, side * units, units, (float *)b[3].buf + w * row);
    }
    leave(&room);
    return released(b, 4);
}

/* NumPy's pairwise sum of numbers that are so many apart. */
#define PAIRWISE_SUM(name, type, apart)                                                                                 \
    static type name(const type *x, Py_ssize_t n)                                                                       \
    {                                                                                                                   \
        type r[8] = {-(type)0}, sum = -(type)0;                                                                         \
        Py_ssize_t half = n / 2 - n / 2 % 8, i = 0;                                                                     \
        if (n > 128)                                                                                                    \
            return name(x, half) + name(x + half * apart, n - half);                                                    \
        for (; i < n - n % 8; i += 8)                                                                                   \
            for (int k = 0; k < 8; k++)                                                                                 \
                r[k] = i ? r[k] + x[(i + k) * apart] : x[k * apart];                                                    \
        if (n >= 8)                                                                                                     \
            sum = ((r[0] + r[1]) + (r[2] + r[3])) + ((r[4] + r[5]) + (r[6] + r[7]));                                    \
        for (; i < n; i++)                                                                                              \
            sum += x[i * apart];                                                                                        \
        return sum;                                                                                                     \
    }
PAIRWISE_SUM(pairwise_sum, float, 1)
PAIRWISE_SUM(pairwise_sum_of_rows, double, COORDINATES)

/* Write what the maps are shown of a frame and of its mirror image, relative to their centres. */
static void map_inputs(const double *posture, const double *velocity, const int32_t *mirror, const double *signs,
                       const int32_t *minuend, const int32_t *subtrahend, const double *weights, const float *centre,
                       float *out, Py_ssize_t inputs)
{
    double row[SIDES][2 * COORDINATES];
    memcpy(row[0], posture, sizeof row[0] / 2);
    memcpy(row[0] + COORDINATES, velocity, sizeof row[0] / 2);
    for (int i = 0; i < 2 * COORDINATES; i++)
        row[1][i] = row[0][mirror[i]] * signs[i];
    for (int side = 0; side < SIDES; side++)
        for (Py_ssize_t i = 0; i < inputs; i++) {
            double value = row[side][minuend[i]];
            if (subtrahend[i] >= 0)
                value = (value - row[side][subtrahend[i]]) * weights[i];
            out[side * inputs + i] = (float)(value - (double)centre[i]);
        }
}

/* The products of both sides' inputs with a map's weights, term after term. The weights are blocks of units, (blocks,
   dim, BLOCK), with zeros for units beyond the last. BLAS adds a product without rounding it where the processor can. */
INLINE void products_of(const float *seen, const float *image, const float *weights, Py_ssize_t dim, Py_ssize_t units,
                        float *of_seen, float *of_image, int fused)
{
    for (Py_ssize_t first = 0; first < units; first += BLOCK) {
        float sums[SIDES][BLOCK];
        size_t written = (units - first < BLOCK ? units - first : BLOCK) * sizeof(float);
        for (int u = 0; u < BLOCK; u++) { /* the first term is added to 0: to clear the sums before costs a tenth of all */
            sums[0][u] = 0.0f + seen[0] * weights[u];
            sums[1][u] = 0.0f + image[0] * weights[u];
        }
        weights += BLOCK;
        for (Py_ssize_t k = 1; k < dim; k++, weights += BLOCK)
            for (int u = 0; u < BLOCK; u++) {
                sums[0][u] = fused ? fmaf(seen[k], weights[u], sums[0][u]) : sums[0][u] + seen[k] * weights[u];
                sums[1][u] = fused ? fmaf(image[k], weights[u], sums[1][u]) : sums[1][u] + image[k] * weights[u];
            }
        memcpy(of_seen + first, sums[0], written);
        memcpy(of_image + first, sums[1], written);
    }
}

FUSED static void fused_products(const float *seen, const float *image, const float *weights, Py_ssize_t dim,
                                 Py_ssize_t units, float *of_seen, float *of_image)
{
    products_of(seen, image, weights, dim, units, of_seen, of_image, 1);
}

static void rounded_products(const float *seen, const float *image, const float *weights, Py_ssize_t dim, Py_ssize_t units,
                             float *of_seen, float *of_image)
{
    products_of(seen, image, weights, dim, units, of_seen, of_image, 0);
}

VECTORISED static float least_of(const float *x, Py_ssize_t n)
{
    float least[LANES], of_all = INFINITY;
    Py_ssize_t i = 0;
    for (int lane = 0; lane < LANES; lane++)
        least[lane] = INFINITY;
    for (; i + LANES <= n; i += LANES)
        for (int lane = 0; lane < LANES; lane++)
            least[lane] = x[i + lane] < least[lane] ? x[i + lane] : least[lane];
    for (; i < n; i++)
        of_all = x[i] < of_all ? x[i] : of_all;
    for (int lane = 0; lane < LANES; lane++)
        of_all = least[lane] < of_all ? least[lane] : of_all;
    return of_all;
}

VECTORISED static void add(const float *x, const float *y, float *sums, Py_ssize_t n)
{
    for (Py_ssize_t i = 0; i < n; i++)
        sums[i] = x[i] + y[i];
}

VECTORISED static void scaled_excess(const float *sums, float least, float slope, float *out, Py_ssize_t units)
{
    for (Py_ssize_t u = 0; u < units; u++)
        out[u] = (sums[u] - least) * 2 * slope;
}

PyDoc_STRVAR(exponents_doc,
    "exponents(posture, velocity, mirror, signs, minuend, subtrahend, weights, dims, centre, slopes, half_norms2, maps,\n"
    "          sides, contrasts, out)\n--\n\n"
    "Write the exponents of a frame's activities, as seen and mirrored, (2, channels * units).");
static PyObject *exponents(PyObject *module, PyObject *args)
{
    Py_buffer b[15];
    if (!PyArg_ParseTuple(args, "y*y*y*y*y*y*y*y*y*y*y*y*y*y*w*", &b[0], &b[1], &b[2], &b[3], &b[4], &b[5], &b[6], &b[7],
                          &b[8], &b[9], &b[10], &b[11], &b[12], &b[13], &b[14]))
        return NULL;
    const int32_t *dims = b[7].buf, *maps = b[11].buf, *sides = b[12].buf;
    const float *slopes = b[9].buf, *half_norms2 = b[10].buf, *contrasts = b[13].buf;
    float *out = b[14].buf;
    Py_ssize_t channels = b[11].len / (Py_ssize_t)sizeof(int32_t), count = b[8].len / (Py_ssize_t)sizeof(float);
    Py_ssize_t units = channels ? b[14].len / (Py_ssize_t)sizeof(float) / SIDES / channels : 0;
    Py_ssize_t width = b[10].len / (Py_ssize_t)sizeof(float), input = 0, padded = (units + BLOCK - 1) / BLOCK * BLOCK;
    float *scores = PyMem_Malloc((SIDES * (width + count) + units) * sizeof(float)), *sums = scores + SIDES * width;
    float *inputs = sums + units;
    if (scores == NULL)
        PyErr_NoMemory();
    else if (units < 1 || b[9].len < count * padded * (Py_ssize_t)sizeof(float))
        PyErr_SetString(PyExc_ValueError, "no channels, or more inputs than there are weights");
    else
        map_inputs(b[0].buf, b[1].buf, b[2].buf, b[3].buf, b[4].buf, b[5].buf, b[6].buf, b[8].buf, inputs, count);
    for (Py_ssize_t map = 0; map < width / units && !PyErr_Occurred(); input += dims[map++])
        (HAS_FUSED ? fused_products : rounded_products)(inputs + input, inputs + count + input, slopes + input * padded,
                                                        dims[map], units, scores + map * units,
                                                        scores + width + map * units);
    for (Py_ssize_t block = 0; block < SIDES * channels && !PyErr_Occurred(); block++) {
        Py_ssize_t channel = block % channels, side = block / channels ^ sides[channel];
        Py_ssize_t first = maps[channel] * units;
        add(scores + side * width + first, half_norms2 + first, sums, units);
        scaled_excess(sums, least_of(sums, units), contrasts[channel], out + block * units, units);
    }
    PyMem_Free(scores);
    return released(b, 15);
}

VECTORISED static void add_quantised(
    const float *activity, float factor, float scale, const uint32_t *before, uint32_t *after, Py_ssize_t units)
{
    for (Py_ssize_t u = 0; u < units; u++)
        after[u] = before[u] + (uint32_t)(int32_t)rintf(activity[u] * factor * scale);
}

static Py_ssize_t first_largest(const float *x, Py_ssize_t n)
{
    Py_ssize_t largest = 0;
    for (Py_ssize_t i = 1; i < n; i++)
        if (x[i] > x[largest])
            largest = i;
    return largest;
}

/* log(d²) of the posture map's quantization error, d in metres; numbers are added up as NumPy adds 45. */
static double log_error(const double *posture, const float *unit, double smallest2)
{
    double r[8] = {0}, sum;
    for (int i = 0; i < COORDINATES; i++) {
        double error = posture[i] - (double)unit[i];
        if (i < COORDINATES - COORDINATES % 8)
            r[i % 8] += error * error;
    }
    sum = ((r[0] + r[1]) + (r[2] + r[3])) + ((r[4] + r[5]) + (r[6] + r[7]));
    for (int i = COORDINATES - COORDINATES % 8; i < COORDINATES; i++) {
        double error = posture[i] - (double)unit[i];
        sum += error * error;
    }
    double error2 = sum / COORDINATES * COORDINATES;
    return log(error2 > smallest2 ? error2 : smallest2);
}

/* Add a frame's totals: displacements (um), moments of the limbs (mm), missing joints, log errors (millionths). */
static void add_totals(const double *motion, const double *posture, const double *image, const int32_t *limbs,
                       const float *units, const Py_ssize_t *winners, double smallest2, int64_t *after)
{
    int64_t *moments = after + PARTS, *errors = after + PARTS + LIMBS * MOMENTS + 1;
    for (int part = 0; part < PARTS; part++)
        after[part] += (int64_t)rint(motion[part] * 1e6);
    for (int limb = 0; limb < LIMBS; limb++) {
        int64_t squares = 0;
        for (int i = 0; i < MOMENTS - 2; i++) {
            int64_t mm = (int64_t)rint(posture[limbs[limb * (MOMENTS - 2) + i]] * 1000);
            moments[limb * MOMENTS + i] += mm;
            squares += mm * mm;
        }
        moments[limb * MOMENTS + MOMENTS - 2] += squares;
        moments[limb * MOMENTS + MOMENTS - 1] += 1;
    }
    errors[0] += (int64_t)rint(log_error(posture, units + winners[0] * COORDINATES, smallest2) * 1e6);
    errors[1] += (int64_t)rint(log_error(image, units + winners[1] * COORDINATES, smallest2) * 1e6);
}

PyDoc_STRVAR(added_doc,
    "added(activities, shares, scale, motion, posture, mirror, signs, units, limbs, smallest2, sums, totals, row)\n"
    "-> (winner, winner in the mirror)\n--\n\n"
    "Add a frame's normalised activities, quantised, to the sums before it, (2, channels * units), and its totals to\n"
    "those before it: from a row of each to the next. Return the posture map's winners.");
static PyObject *added(PyObject *module, PyObject *args)
{
    Py_buffer b[10];
    float scale;
    double smallest2, image[COORDINATES];
    Py_ssize_t row, winners[SIDES];
    if (!PyArg_ParseTuple(args, "y*y*fy*y*y*y*y*y*dw*w*n", &b[0], &b[1], &scale, &b[2], &b[3], &b[4], &b[5], &b[6], &b[7],
                          &smallest2, &b[8], &b[9], &row))
        return NULL;
    const float *activities = b[0].buf, *shares = b[1].buf;
    const double *posture = b[3].buf, *signs = b[5].buf;
    const int32_t *mirror = b[4].buf;
    Py_ssize_t channels = b[1].len / (Py_ssize_t)sizeof(float), all = b[0].len / (Py_ssize_t)sizeof(float);
    Py_ssize_t units = channels ? all / SIDES / channels : 0, rows = row < 0 ? 0 : row + 2;
    const size_t bytes[10] = {
        SIDES * channels * sizeof(float), sizeof(float), PARTS * sizeof(double), sizeof image,
        COORDINATES * sizeof(int32_t), sizeof image, units * COORDINATES * sizeof(float),
        LIMBS * (MOMENTS - 2) * sizeof(int32_t), rows * all * sizeof(uint32_t), rows * TOTALS * sizeof(int64_t)};
    if (row < 0)
        PyErr_SetString(PyExc_ValueError, "there is no row before the first");
    if (row < 0 || !are_long_enough(b, bytes, 10))
        return released(b, 10);
    uint32_t *before = (uint32_t *)b[8].buf + row * all, *after = before + all;
    int64_t *totals = (int64_t *)b[9].buf + (row + 1) * TOTALS;
    for (Py_ssize_t block = 0; block < SIDES * channels; block++) {
        const float *activity = activities + block * units;
        float factor = shares[block % channels] / pairwise_sum(activity, units);
        add_quantised(activity, factor, scale, before + block * units, after + block * units, units);
        if (block % channels == 0)
            winners[block / channels] = first_largest(activity, units);
    }
    for (int i = 0; i < COORDINATES; i++)
        image[i] = posture[mirror[i]] * signs[i];
    memcpy(totals, totals - TOTALS, TOTALS * sizeof *totals);
    add_totals(b[2].buf, posture, image, b[7].buf, b[6].buf, winners, smallest2, totals);
    for (int n = 0; n < 10; n++)
        PyBuffer_Release(&b[n]);
    return Py_BuildValue("nn", winners[0], winners[1]);
}

PyDoc_STRVAR(smoothed_doc,
    "smoothed(joints, before, state, elapsed_s, gain, still_s, still_mps, lag_s, decay, out) -> bool\n--\n\n"
    "Advance the kinematics of all joints: their state, which is speeds, smooth and lagging positions, (3, 15, 3), and\n"
    "write smooth positions and velocities, (2, 15, 3). False, and nothing is done, where a joint is not known.");
static PyObject *smoothed(PyObject *module, PyObject *args)
{
    Py_buffer b[4];
    int known = 1;
    double elapsed_s, gain, still_s, still_mps, lag_s, decay;
    if (!PyArg_ParseTuple(args, "y*y*w*ddddddw*", &b[0], &b[1], &b[2], &elapsed_s, &gain, &still_s, &still_mps, &lag_s,
                          &decay, &b[3]))
        return NULL;
    const double *joints = b[0].buf, *before = b[1].buf;
    double *speed = b[2].buf, *smooth = speed + COORDINATES, *lagging = smooth + COORDINATES, *out = b[3].buf;
    const size_t one = COORDINATES * sizeof(double), bytes[4] = {one, one, 3 * one, 2 * one};
    if (!are_long_enough(b, bytes, 4))
        return released(b, 4);
    for (int joint = 0; joint < JOINTS; joint++)
        known &= !isnan(joints[3 * joint]);
    for (int joint = 0; joint < JOINTS && known; joint++) {
        double speed2 = 0.0;
        for (int i = 3 * joint; i < 3 * joint + 3; i++) {
            speed[i] = speed[i] + gain * ((joints[i] - before[i]) / elapsed_s - speed[i]);
            speed2 += speed[i] * speed[i];
        }
        double share = 1 - exp(elapsed_s / -still_s * (1 + sqrt(speed2) / still_mps));
        for (int i = 3 * joint; i < 3 * joint + 3; i++) {
            double step = share * (joints[i] - smooth[i]), behind = lag_s / elapsed_s * step;
            lagging[i] = smooth[i] + step - behind + (lagging[i] - smooth[i] + behind) * decay;
            smooth[i] = smooth[i] + step;
            out[i] = smooth[i];
            out[COORDINATES + i] = smooth[i] - lagging[i];
        }
    }
    for (int n = 0; n < 4; n++)
        PyBuffer_Release(&b[n]);
    return PyBool_FromLong(known);
}

static double length3(const double *v) { return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

static int unit3(const double *v, double shortest, double *out)
{
    double length = length3(v);
    for (int i = 0; i < 3; i++)
        out[i] = v[i] / length;
    return length >= shortest;
}

/* The egocentric frame (4, 4) of joints (15, 3), as geometry.ego_from_camera builds it; 0 where it is not defined. */
static int ego_from_camera(const double *joints, const int32_t *hips_torso, double shortest, double *ego)
{
    const double *right = joints + 3 * hips_torso[0], *left = joints + 3 * hips_torso[1];
    const double *torso = joints + 3 * hips_torso[2];
    double across[3], trunk[3], origin[3], along = 0.0;
    for (int i = 0; i < 3; i++)
        across[i] = left[i] - right[i];
    memset(ego, 0, 16 * sizeof *ego);
    double *x = ego, *y = ego + 4, *z = ego + 8;
    if (!unit3(across, shortest, x))
        return 0;
    for (int i = 0; i < 3; i++)
        along += (torso[i] - right[i]) * x[i];
    for (int i = 0; i < 3; i++) {
        origin[i] = right[i] + along * x[i];
        trunk[i] = torso[i] - origin[i];
    }
    if (!unit3(trunk, shortest, y))
        return 0;
    for (int i = 0; i < 3; i++)
        z[i] = x[(i + 1) % 3] * y[(i + 2) % 3] - x[(i + 2) % 3] * y[(i + 1) % 3];
    for (int row = 0; row < 3; row++)
        ego[4 * row + 3] = -(ego[4 * row] * origin[0] + ego[4 * row + 1] * origin[1] + ego[4 * row + 2] * origin[2]);
    ego[15] = 1.0;
    return 1;
}

static void apply(const double *transform, const double *joints, double *out)
{
    for (int joint = 0; joint < JOINTS; joint++, joints += 3)
        for (int row = 0; row < 3; row++, out++)
            *out = transform[4 * row] * joints[0] + transform[4 * row + 1] * joints[1] + transform[4 * row + 2] * joints[2]
                + transform[4 * row + 3];
}

/* Whether this is a list of so many joints, each None or a list of three floats, and nothing else. */
static int are_plain_joints(PyObject *joints)
{
    if (!PyList_CheckExact(joints) || PyList_Size(joints) != JOINTS)
        return 0;
    for (int joint = 0; joint < JOINTS; joint++) {
        PyObject *point = PyList_GetItem(joints, joint);
        if (point == Py_None)
            continue;
        if (!PyList_CheckExact(point) || PyList_Size(point) != 3)
            return 0;
        for (int i = 0; i < 3; i++)
            if (!PyFloat_CheckExact(PyList_GetItem(point, i)))
                return 0;
    }
    return 1;
}

PyDoc_STRVAR(plain_joints_or_doc,
    "plain_joints_or(value, validate)\n--\n\n"
    "Return a list of joints, each None or a list of three floats, as it is; what another value is, `validate` says.");
static PyObject *plain_joints_or(PyObject *module, PyObject *const *args, Py_ssize_t count)
{
    if (count != 2) {
        PyErr_SetString(PyExc_TypeError, "a value and what validates it are needed");
        return NULL;
    }
    return are_plain_joints(args[0]) ? Py_NewRef(args[0]) : PyObject_CallFunctionObjArgs(args[1], args[0], NULL);
}

/* Read a message's joints, a list of fifteen lists of three numbers, NaN where one is unknown (None). Return how many
   are unknown, -1 where an error is set. */
static int read_joints(PyObject *joints, double *out)
{
    int unknown = 0;
    if (!PyList_Check(joints) || PyList_Size(joints) != JOINTS) {
        PyErr_SetString(PyExc_ValueError, "the joints are not a list of fifteen");
        return -1;
    }
    for (int joint = 0; joint < JOINTS; joint++) {
        PyObject *point = PyList_GetItem(joints, joint);
        int known = point != Py_None;
        if (known && (!PyList_Check(point) || PyList_Size(point) != 3)) {
            PyErr_SetString(PyExc_ValueError, "a joint is not a list of three numbers");
            return -1;
        }
        unknown += !known;
        for (int i = 0; i < 3; i++) {
            PyObject *number = known ? PyList_GetItem(point, i) : NULL;
            if (known && !PyFloat_Check(number) && !PyLong_CheckExact(number)) { /* another may run code as it is read */
                PyErr_SetString(PyExc_TypeError, "a coordinate is not a number");
                return -1;
            }
            *out++ = known ? PyFloat_AsDouble(number) : NAN;
        }
    }
    return PyErr_Occurred() ? -1 : unknown;
}

static PyObject *listed(const double *numbers, int count)
{
    PyObject *list = PyList_New(count);
    for (int i = 0; list != NULL && i < count; i++) {
        PyObject *number = PyFloat_FromDouble(numbers[i]);
        if (number == NULL)
            Py_CLEAR(list);
        else
            PyList_SetItem(list, i, number);
    }
    return list;
}

static PyObject *listed_joints(const double *joints)
{
    PyObject *list = PyList_New(JOINTS);
    for (int joint = 0; list != NULL && joint < JOINTS; joint++) {
        PyObject *point = listed(joints + 3 * joint, 3);
        if (point == NULL)
            Py_CLEAR(list);
        else
            PyList_SetItem(list, joint, point);
    }
    return list;
}

PyDoc_STRVAR(body_doc,
    "body(joints, parents, children, lengths_m, hips_torso, reach_m, bone_m, shortest_m, out) -> bool\n--\n\n"
    "Write a message's joints as they are and with standard bones, the egocentric frame, and both in it,\n"
    "(45 + 45 + 16 + 45 + 45). False where a joint is unknown or, as a bone, not usable.");
static PyObject *body(PyObject *module, PyObject *args)
{
    PyObject *message;
    Py_buffer b[5];
    double reach_m, bone_m, shortest_m, ego[16];
    if (!PyArg_ParseTuple(args, "Oy*y*y*y*dddw*", &message, &b[0], &b[1], &b[2], &b[3], &reach_m, &bone_m, &shortest_m,
                          &b[4]))
        return NULL;
    const size_t of_bones = (JOINTS - 1) * sizeof(int32_t);
    const size_t bytes[5]
        = {of_bones, of_bones, (JOINTS - 1) * sizeof(double), 3 * sizeof(int32_t), BODY * sizeof(double)};
    if (!are_long_enough(b, bytes, 5))
        return released(b, 5);
    const double *lengths_m = b[2].buf;
    const int32_t *parents = b[0].buf, *children = b[1].buf, *hips_torso = b[3].buf, torso = hips_torso[2];
    double *joints = b[4].buf, *scaled = joints + COORDINATES, *frame = scaled + COORDINATES;
    double *measured_ego = frame + 16, *scaled_ego = measured_ego + COORDINATES, from_torso[COORDINATES] = {0};
    int usable = read_joints(message, joints) == 0;
    for (int i = 0; i < COORDINATES; i++)
        usable &= fabs(joints[i]) <= reach_m;
    for (int bone = 0; bone < JOINTS - 1; bone++) {
        double vector[3], length;
        for (int i = 0; i < 3; i++)
            vector[i] = joints[3 * children[bone] + i] - joints[3 * parents[bone] + i];
        length = length3(vector);
        usable &= length >= shortest_m && length * length <= bone_m * bone_m;
        for (int i = 0; i < 3; i++)
            from_torso[3 * children[bone] + i] = from_torso[3 * parents[bone] + i] + vector[i] * (lengths_m[bone] / length);
    }
    for (int i = 0; i < COORDINATES; i++)
        scaled[i] = joints[3 * torso + i % 3] + from_torso[i];
    usable = usable && ego_from_camera(joints, hips_torso, shortest_m, frame)
        && ego_from_camera(scaled, hips_torso, shortest_m, ego);
    if (usable) {
        apply(frame, joints, measured_ego);
        apply(ego, scaled, scaled_ego);
    }
    for (int n = 0; n < 5; n++)
        PyBuffer_Release(&b[n]);
    return PyErr_Occurred() ? NULL : PyBool_FromLong(usable);
}

/* Whether all numbers that are not unknown lie within the bounds, and some are known. */
static int within(const double *numbers, int count, int unknown, double most)
{
    int within_bounds = 0;
    for (int i = 0; i < count; i++)
        within_bounds += fabs(numbers[i]) < most;
    return within_bounds > 0 && within_bounds == count - unknown;
}

PyDoc_STRVAR(usable_doc,
    "usable(joints, upright, motion, torso, most_m, out) -> tuple or None\n--\n\n"
    "Write a posture's joints, upright ones and motion, (45 + 45 + 5), and return which of the upright joints are\n"
    "unknown; None where something is absurd, or no joint known. Without upright joints (None) they are relative to the\n"
    "torso.");
static PyObject *usable(PyObject *module, PyObject *args)
{
    PyObject *joint_list, *upright_list, *motion_list, *missing = NULL;
    Py_buffer b;
    int torso;
    double most_m;
    if (!PyArg_ParseTuple(args, "OOO!idw*", &joint_list, &upright_list, &PyList_Type, &motion_list, &torso, &most_m, &b))
        return NULL;
    const size_t bytes = (2 * COORDINATES + PARTS) * sizeof(double);
    if (!are_long_enough(&b, &bytes, 1))
        return released(&b, 1);
    double *joints = b.buf, *upright = joints + COORDINATES, *motion = upright + COORDINATES;
    int unknown = read_joints(joint_list, joints);
    int unknown_upright = upright_list == Py_None ? unknown : read_joints(upright_list, upright);
    for (int i = 0; upright_list == Py_None && i < COORDINATES; i++)
        upright[i] = joints[i] - joints[3 * torso + i % 3];
    for (int part = 0; part < PARTS && !PyErr_Occurred(); part++)
        motion[part] = PyFloat_AsDouble(PyList_GetItem(motion_list, part));
    int is_usable = !PyErr_Occurred() && within(joints, COORDINATES, 3 * unknown, most_m)
        && within(upright, COORDINATES, 3 * unknown_upright, most_m) && within(motion, PARTS, 0, most_m);
    if (is_usable)
        missing = PyTuple_New(unknown_upright);
    for (int joint = 0, n = 0; missing != NULL && joint < JOINTS; joint++)
        if (isnan(upright[3 * joint]))
            PyTuple_SetItem(missing, n++, PyLong_FromLong(joint));
    PyBuffer_Release(&b);
    if (is_usable || PyErr_Occurred())
        return missing;
    Py_RETURN_NONE;
}

/* Turn points by a rotation (3, 3) as BLAS multiplies: each product after the first is added without rounding it. */
static void turned(const double *rotation, const double *points, double *out)
{
    for (int joint = 0; joint < JOINTS; joint++, points += 3)
        for (int row = 0; row < 3; row++)
            *out++ = fma(points[2], rotation[3 * row + 2], fma(points[1], rotation[3 * row + 1],
                                                                points[0] * rotation[3 * row]));
}

/* The mean direction (x, z) from right to left hip and shoulder, of those that are long enough, as
   heading.horizontal_left. */
static void horizontal_left(const double *joints, const int32_t *pairs, double shortest, double *left)
{
    double sum[3] = {0};
    int known = 0;
    for (int pair = 0; pair < 2; pair++) {
        double across[3], unit[3];
        for (int i = 0; i < 3; i++)
            across[i] = joints[3 * pairs[2 + pair] + i] - joints[3 * pairs[pair] + i];
        if (!unit3(across, shortest, unit))
            continue;
        known++;
        for (int i = 0; i < 3; i++)
            sum[i] += unit[i];
    }
    left[0] = known == 2 ? sum[0] / 2 : sum[0];
    left[1] = known == 2 ? sum[2] / 2 : sum[2];
}

enum { SPAN, MEAN_X, MEAN_Z, VARIANCE, LEFT_X, LEFT_Z };
enum { FIRST_S, TURNING_S, SHORTEST_MEAN, INFLATION, FACING_VARIANCE, FULL_TURN };

/* Advance the state of a HeadingFilter, (6,), by the direction to the left, as HeadingFilter does. */
static void advance_heading(double *state, const double *left, double elapsed_s, const double *tuned)
{
    if (elapsed_s <= 0) {
        state[SPAN] = tuned[FIRST_S];
        state[MEAN_X] = left[0];
        state[MEAN_Z] = left[1];
        state[VARIANCE] = 0.0;
    } else {
        state[SPAN] += elapsed_s;
        double gain = 1.0 - exp(-elapsed_s / tuned[TURNING_S]), share = elapsed_s / state[SPAN];
        double weight = share > gain ? share : gain;
        state[MEAN_X] += weight * (left[0] - state[MEAN_X]);
        state[MEAN_Z] += weight * (left[1] - state[MEAN_Z]);
        if (hypot(left[0], left[1]) >= tuned[SHORTEST_MEAN]) {
            double error_rad
                = remainder(atan2(left[1], left[0]) - atan2(state[MEAN_Z], state[MEAN_X]), tuned[FULL_TURN]);
            state[VARIANCE] += gain * (error_rad * error_rad - state[VARIANCE]);
        }
    }
    if (hypot(state[MEAN_X], state[MEAN_Z]) >= tuned[SHORTEST_MEAN]) {
        double seen_rad = atan2(state[MEAN_Z], state[MEAN_X]), facing = cos(seen_rad);
        double variance = tuned[INFLATION] * state[VARIANCE];
        double yaw_rad
            = seen_rad * (1.0 - (facing > 0.0 ? facing : 0.0) * variance / (variance + tuned[FACING_VARIANCE]));
        state[LEFT_X] = cos(yaw_rad);
        state[LEFT_Z] = sin(yaw_rad);
    }
}

/* Advance the low-passed joints relative to the torso, and write each part's mean displacement, as PartMotionFilter. */
static void advance_motion(double *smooth, const double *joints, int torso, double gain, const int32_t *part_of, double *motion)
{
    int known[PARTS] = {0};
    memset(motion, 0, PARTS * sizeof *motion);
    for (int joint = 0; joint < JOINTS; joint++) {
        double step[3], length;
        for (int i = 0; i < 3; i++) {
            double relative = joints[3 * joint + i] - joints[3 * torso + i];
            step[i] = gain * (relative - smooth[3 * joint + i]);
            smooth[3 * joint + i] = isnan(step[i]) ? relative : smooth[3 * joint + i] + step[i];
        }
        length = length3(step);
        if (!isnan(length)) {
            motion[part_of[joint]] += length;
            known[part_of[joint]]++;
        }
    }
    for (int part = 0; part < PARTS; part++)
        motion[part] /= known[part] ? known[part] : 1;
}

PyDoc_STRVAR(posture_doc,
    "posture(body, level, heading, elapsed_s, pairs, tuned, shortest_m, smooth, gain, torso, part_of)\n"
    "--\n\n"
    "Advance a person's filters by what `body` wrote, and return the lists of a posture: the joints in the egocentric\n"
    "frame, measured and with standard bones, upright ones, that frame, and the motion of each part.");
static PyObject *posture(PyObject *module, PyObject *args)
{
    Py_buffer b[7];
    double elapsed_s, shortest_m, gain;
    int torso;
    if (!PyArg_ParseTuple(args, "y*z*w*dy*y*dw*diy*", &b[0], &b[1], &b[2], &elapsed_s, &b[3], &b[4], &shortest_m, &b[5],
                          &gain, &torso, &b[6]))
        return NULL;
    const double *joints = b[0].buf, *scaled = joints + COORDINATES, *frame = scaled + COORDINATES;
    const double *level = b[1].buf, *metric = joints;
    double turned_metric[COORDINATES], turned_scaled[COORDINATES], upright[COORDINATES], left[2], motion[PARTS] = {0};
    double *heading = b[2].buf, *smooth = b[5].buf;
    const size_t bytes[7] = {BODY * sizeof(double), level ? 9 * sizeof(double) : 0, 6 * sizeof(double),
                             4 * sizeof(int32_t), 6 * sizeof(double), COORDINATES * sizeof(double),
                             JOINTS * sizeof(int32_t)};
    if (!are_long_enough(b, bytes, 7))
        return released(b, 7);
    if (level != NULL) {
        turned(level, joints, turned_metric);
        turned(level, scaled, turned_scaled);
        metric = turned_metric;
        scaled = turned_scaled;
    }
    horizontal_left(metric, b[3].buf, shortest_m, left);
    advance_heading(heading, left, elapsed_s, b[4].buf);
    for (int i = 0; i < COORDINATES; i++)
        upright[i] = scaled[i] - scaled[3 * torso + i % 3];
    const double axes[9] = {heading[LEFT_X], 0, heading[LEFT_Z], 0, -1, 0, heading[LEFT_Z], 0, -heading[LEFT_X]};
    memcpy(turned_scaled, upright, sizeof upright);
    turned(axes, turned_scaled, upright);
    if (gain > 0)
        advance_motion(smooth, joints, torso, gain, b[6].buf, motion);
    else
        for (int i = 0; i < COORDINATES; i++)
            smooth[i] = joints[i] - joints[3 * torso + i % 3];
    PyObject *lists[5] = {listed_joints(frame + 16), listed_joints(frame + 16 + COORDINATES), listed_joints(upright),
                          listed(frame, 16), listed(motion, PARTS)};
    for (int n = 0; n < 7; n++)
        PyBuffer_Release(&b[n]);
    return Py_BuildValue("NNNNN", lists[0], lists[1], lists[2], lists[3], lists[4]);
}

PyDoc_STRVAR(spreads_doc,
    "spreads(before, after) -> list\n--\n\n"
    "Return each limb's spread (mm) over the frames between two sums of moments.");
static PyObject *spreads(PyObject *module, PyObject *args)
{
    Py_buffer b[2];
    double of[LIMBS];
    if (!PyArg_ParseTuple(args, "y*y*", &b[0], &b[1]))
        return NULL;
    const size_t bytes[2] = {LIMBS * MOMENTS * sizeof(int64_t), LIMBS * MOMENTS * sizeof(int64_t)};
    if (!are_long_enough(b, bytes, 2))
        return released(b, 2);
    spreads_between(b[0].buf, b[1].buf, of);
    PyBuffer_Release(&b[0]);
    PyBuffer_Release(&b[1]);
    return Py_BuildValue("[dddd]", of[0], of[1], of[2], of[3]);
}

PyDoc_STRVAR(left_arm_acts_doc,
    "left_arm_acts(before, after, first, jitter_mm, factor) -> bool\n--\n\n"
    "Tell whether of all limbs the left arm moves most over the frames between two sums, and clearly more than the right.");
static PyObject *left_arm_acts(PyObject *module, PyObject *args)
{
    Py_buffer b[2];
    Py_ssize_t first;
    double jitter_mm, factor;
    if (!PyArg_ParseTuple(args, "y*y*ndd", &b[0], &b[1], &first, &jitter_mm, &factor))
        return NULL;
    const size_t least = (first + LIMBS * MOMENTS) * sizeof(int64_t), bytes[2] = {least, least};
    if (!are_long_enough(b, bytes, 2))
        return released(b, 2);
    int acts = left_arm_moves_most((const int64_t *)b[0].buf + first, (const int64_t *)b[1].buf + first, jitter_mm, factor);
    PyBuffer_Release(&b[0]);
    PyBuffer_Release(&b[1]);
    return PyBool_FromLong(acts);
}

VECTORISED static void excess_over_contrast(const float *scores, float least, float contrast, float *out, Py_ssize_t units)
{
    for (Py_ssize_t u = 0; u < units; u++)
        out[u] = (scores[u] - least) * 2 / -contrast;
}

PyDoc_STRVAR(contrasted_doc,
    "contrasted(scores, contrast, out)\n--\n\n"
    "Write the exponents of a map's activity from its scores, of which there are as many as units, or more at the end.");
static PyObject *contrasted(PyObject *module, PyObject *args)
{
    Py_buffer b[2];
    float contrast;
    if (!PyArg_ParseTuple(args, "y*fw*", &b[0], &contrast, &b[1]))
        return NULL;
    const float *scores = b[0].buf;
    Py_ssize_t units = b[1].len / (Py_ssize_t)sizeof(float);
    if (b[0].len < b[1].len)
        PyErr_SetString(PyExc_ValueError, "there are fewer scores than units");
    else
        excess_over_contrast(scores, least_of(scores, units), contrast, b[1].buf, units);
    return released(b, 2);
}

VECTORISED static void scale_and_centre(float *activities, float length, const float *mean, Py_ssize_t units)
{
    for (Py_ssize_t u = 0; u < units; u++)
        activities[u] = activities[u] / length - mean[u];
}

PyDoc_STRVAR(centred_doc,
    "centred(activities, square, mean)\n--\n\n"
    "Scale a map's activities, whose squares add up to `square`, to unit length, and subtract their mean, in place.");
static PyObject *centred(PyObject *module, PyObject *args)
{
    Py_buffer b[2];
    float square;
    if (!PyArg_ParseTuple(args, "w*fy*", &b[0], &square, &b[1]))
        return NULL;
    if (b[0].len != b[1].len)
        PyErr_SetString(PyExc_ValueError, "the mean is not that of as many units");
    else
        scale_and_centre(b[0].buf, sqrtf(square), b[1].buf, b[0].len / (Py_ssize_t)sizeof(float));
    return released(b, 2);
}

VECTORISED static void add_row(const float *activity, float scale, const uint32_t *before, uint32_t *after, Py_ssize_t n)
{
    for (Py_ssize_t u = 0; u < n; u++)
        after[u] = before[u] + (uint32_t)(int32_t)rintf(activity[u] * scale);
}

PyDoc_STRVAR(running_sums_doc,
    "running_sums(activities, scale, sums)\n--\n\n"
    "Write the sums of quantised activities (n, units) before each row and after the last, (n + 1, units).");
static PyObject *running_sums(PyObject *module, PyObject *args)
{
    Py_buffer b[2];
    float scale;
    Py_ssize_t units;
    if (!PyArg_ParseTuple(args, "y*fnw*", &b[0], &scale, &units, &b[1]))
        return NULL;
    const float *activities = b[0].buf;
    uint32_t *sums = b[1].buf;
    if (units < 1 || b[1].len != b[0].len + units * (Py_ssize_t)sizeof *sums) {
        PyErr_SetString(PyExc_ValueError, "there are not as many rows of sums as rows of activities and one");
        return released(b, 2);
    }
    memset(sums, 0, units * sizeof *sums);
    for (Py_ssize_t row = 0; row < b[0].len / (Py_ssize_t)sizeof(float) / units; row++)
        add_row(activities + row * units, scale, sums + row * units, sums + (row + 1) * units, units);
    return released(b, 2);
}

/* exp(x) of x from -87 to 0, to two units in the last place, as a polynomial about the nearest multiple of ln 2. */
INLINE float exp_below(float x)
{
    const float round = 12582912.0f, whole = (x * 1.44269504f + round) - round;
    float rest = (x - whole * 0.693359375f) + whole * 2.12194440e-4f, power;
    float sum = ((((1.9875691500e-4f * rest + 1.3981999507e-3f) * rest + 8.3334519073e-3f) * rest + 4.1665795894e-2f) * rest
                 + 1.6666665459e-1f) * rest + 5.0000001201e-1f;
    int32_t bits = ((int32_t)whole + 127) << 23;
    memcpy(&power, &bits, sizeof power);
    return (sum * rest * rest + rest + 1.0f) * power;
}

/* The activities of a map for one input, before they are divided by their sum. */
VECTORISED static void activities_of(const float *scores, float least, float slope, float *out, Py_ssize_t units)
{
    for (Py_ssize_t u = 0; u < units; u++) {
        float exponent = (scores[u] - least) * 2 * slope;
        out[u] = exp_below(exponent < -87.0f ? -87.0f : exponent);
    }
}

/* The maps of the first layer and its channels, as the compiled steps read them; see `exponents`. */
typedef struct {
    const int32_t *mirror, *minuend, *subtrahend, *dims, *maps, *sides;
    const double *signs, *weights;
    const float *centre, *slopes, *half_norms2, *contrasts, *shares;
    Py_ssize_t inputs, units, padded, channels;
    float scale;
} Layer;

/* Add up the quantised activities of two frames, of which the second may be left out: write the rows after `sums`. */
static void add_frames(const Layer *layer, const double *postures, const double *velocities, int count, float *room,
                       uint32_t *sums)
{
    float *activity = room + 2 * layer->units, *inputs = activity + layer->units;
    Py_ssize_t units = layer->units, width = layer->channels * units, of_frame = SIDES * layer->inputs;
    for (int frame = 0; frame < 2; frame++)
        map_inputs(postures + frame % count * COORDINATES, velocities + frame % count * COORDINATES, layer->mirror, layer->signs,
                   layer->minuend, layer->subtrahend, layer->weights, layer->centre, inputs + frame * of_frame, layer->inputs);
    for (Py_ssize_t channel = 0; channel < layer->channels; channel++) {
        int map = layer->maps[channel], side = layer->sides[channel];
        Py_ssize_t input = 0;
        for (int before = 0; before < map; before++)
            input += layer->dims[before];
        const float *shown = inputs + side * layer->inputs + input, *weights = layer->slopes + input * layer->padded;
        (HAS_FUSED ? fused_products : rounded_products)(shown, shown + of_frame, weights, layer->dims[map], units, room,
                                                        room + units);
        for (int frame = 0; frame < count; frame++) {
            float *scores = room + frame * units;
            uint32_t *row = sums + frame * width + channel * units;
            add(scores, layer->half_norms2 + map * units, scores, units);
            activities_of(scores, least_of(scores, units), layer->contrasts[channel], activity, units);
            add_quantised(activity, layer->shares[channel] / pairwise_sum(activity, units), layer->scale, row, row + width, units);
        }
    }
}

PyDoc_STRVAR(added_frames_doc,
    "added_frames(postures, velocities, mirror, signs, minuend, subtrahend, weights, dims, centre, slopes, half_norms2,\n"
    "             maps, sides, contrasts, shares, scale, sums)\n--\n\n"
    "Add up the quantised activities of many frames, of which no joint is missing: write all rows of sums but the\n"
    "first, (frames + 1, channels * units).");
static PyObject *added_frames(PyObject *module, PyObject *args)
{
    Py_buffer b[16];
    float scale;
    if (!PyArg_ParseTuple(args, "y*y*y*y*y*y*y*y*y*y*y*y*y*y*y*fw*", &b[0], &b[1], &b[2], &b[3], &b[4], &b[5], &b[6], &b[7],
                          &b[8], &b[9], &b[10], &b[11], &b[12], &b[13], &b[14], &scale, &b[15]))
        return NULL;
    const double *postures = b[0].buf, *velocities = b[1].buf;
    Py_ssize_t frames = b[0].len / (Py_ssize_t)sizeof(double) / COORDINATES, real = sizeof(float);
    Py_ssize_t channels = b[11].len / (Py_ssize_t)sizeof(int32_t), inputs = b[8].len / real;
    Py_ssize_t units = channels ? b[15].len / (Py_ssize_t)sizeof(uint32_t) / (frames + 1) / channels : 0;
    Py_ssize_t padded = (units + BLOCK - 1) / BLOCK * BLOCK;
    Layer layer = {b[2].buf, b[4].buf, b[5].buf, b[7].buf, b[11].buf, b[12].buf, b[3].buf, b[6].buf, b[8].buf, b[9].buf,
                   b[10].buf, b[13].buf, b[14].buf, inputs, units, padded, channels, scale};
    float *room = PyMem_Malloc((3 * units + 2 * SIDES * inputs) * sizeof *room + 1);
    if (room == NULL)
        PyErr_NoMemory();
    else if (units < 1 || b[1].len != b[0].len || b[9].len < inputs * padded * real
             || b[15].len != (frames + 1) * channels * units * (Py_ssize_t)sizeof(uint32_t))
        PyErr_SetString(PyExc_ValueError, "no channels, or arrays of other lengths");
    else {
        Py_BEGIN_ALLOW_THREADS
        for (Py_ssize_t first = 0; first < frames; first += 2)
            add_frames(&layer, postures + first * COORDINATES, velocities + first * COORDINATES, first + 1 < frames ? 2 : 1, room,
                       (uint32_t *)b[15].buf + first * channels * units);
        Py_END_ALLOW_THREADS
    }
    PyMem_Free(room);
    return released(b, 16);
}

VECTORISED static double dot(const double *x, const double *y, Py_ssize_t n)
{
    double of_lane[LANES] = {0}, sum = 0;
    Py_ssize_t i = 0;
    for (; i + LANES <= n; i += LANES)
        for (int lane = 0; lane < LANES; lane++)
            of_lane[lane] += x[i + lane] * y[i + lane];
    for (; i < n; i++)
        sum += x[i] * y[i];
    for (int lane = 0; lane < LANES; lane++)
        sum += of_lane[lane];
    return sum;
}

VECTORISED static void add_times(double *x, double factor, const double *y, Py_ssize_t n)
{
    for (Py_ssize_t i = 0; i < n; i++)
        x[i] += factor * y[i];
}

VECTORISED static void divide(double *x, double by, Py_ssize_t n)
{
    for (Py_ssize_t i = 0; i < n; i++)
        x[i] /= by;
}

PyDoc_STRVAR(adapted_doc,
    "adapted(weights, inputs, targets, order, beta)\n--\n\n"
    "Apply the delta rule to neurons' weights (actions, width), in place, for some of the inputs (n, width) in this order.");
static PyObject *adapted(PyObject *module, PyObject *args)
{
    Py_buffer b[4];
    double beta;
    if (!PyArg_ParseTuple(args, "w*y*y*y*d", &b[0], &b[1], &b[2], &b[3], &beta))
        return NULL;
    const int64_t *targets = b[2].buf, *order = b[3].buf;
    Py_ssize_t count = b[2].len / 8, shown = b[3].len / 8, width = count ? b[1].len / 8 / count : 0;
    Py_ssize_t actions = width ? b[0].len / 8 / width : 0;
    int fits = actions > 0 && b[0].len == actions * width * 8;
    for (Py_ssize_t n = 0; n < shown && fits; n++)
        fits = order[n] >= 0 && order[n] < count;
    if (!fits)
        PyErr_SetString(PyExc_ValueError, "the weights and the inputs have different widths, or an input is missing");
    for (Py_ssize_t n = 0; n < shown && fits; n++)
        for (Py_ssize_t action = 0; action < actions; action++) {
            const double *x = (const double *)b[1].buf + order[n] * width;
            double *weights = (double *)b[0].buf + action * width;
            add_times(weights, beta * ((action == targets[order[n]]) - dot(weights, x, width)), x, width);
            divide(weights, sqrt(dot(weights, weights, width)), width);
        }
    return released(b, 4);
}

typedef struct {
    int64_t lag_ns, memory_ns, decided_ns;
    double overlap;
    const int64_t *starts_ns, *ends_ns;
    const double *gains;
    Py_ssize_t *pending, waiting, *step, *before; /* step, before: the best set's last member up to each, and before it */
    double *best;
} Decoding;

/* Find the best set of those that wait, as best_set does; write its members in order to `chosen`. */
static Py_ssize_t best_set(Decoding *d, Py_ssize_t *chosen)
{
    Py_ssize_t count = 0;
    d->best[0] = 0.0;
    d->step[0] = 0;
    for (Py_ssize_t n = 1; n <= d->waiting; n++) {
        Py_ssize_t candidate = d->pending[n - 1], low = 0, high = n;
        while (low < high) { /* the first of those before it that ends at its start or later; the 0th ended at -1 */
            Py_ssize_t middle = (low + high) / 2;
            int64_t end_ns = middle ? d->ends_ns[d->pending[middle - 1]] : -1;
            if (end_ns < d->starts_ns[candidate])
                low = middle + 1;
            else
                high = middle;
        }
        d->before[n] = low > 0 ? low - 1 : 0;
        double gain = d->best[d->before[n]] + d->gains[candidate];
        d->step[n] = gain > d->best[n - 1];
        d->best[n] = d->step[n] ? gain : d->best[n - 1];
    }
    for (Py_ssize_t n = d->waiting; n > 0; n = d->step[n] ? d->before[n] : n - 1)
        count += d->step[n];
    for (Py_ssize_t n = d->waiting, k = count; n > 0; n = d->step[n] ? d->before[n] : n - 1)
        if (d->step[n])
            chosen[--k] = d->pending[n - 1];
    return count;
}

/* Take the candidates that end now, up to `after`, and append to `found` what is decided; -1 where an error is set. */
static int decode_step(Decoding *d, int64_t now_ns, Py_ssize_t *next, Py_ssize_t after, Py_ssize_t *chosen, PyObject *found)
{
    Py_ssize_t kept = 0, count;
    int64_t decided_ns = d->decided_ns;
    while (*next < after && d->ends_ns[*next] == now_ns)
        d->pending[d->waiting++] = (*next)++;
    for (Py_ssize_t n = 0; n < d->waiting; n++) {
        int64_t start_ns = d->starts_ns[d->pending[n]], end_ns = d->ends_ns[d->pending[n]];
        if (end_ns >= now_ns - d->memory_ns && end_ns > decided_ns
            && (double)(decided_ns - start_ns) <= d->overlap * (double)(end_ns - start_ns))
            d->pending[kept++] = d->pending[n];
    }
    d->waiting = kept;
    count = best_set(d, chosen);
    for (Py_ssize_t k = 0; k < count && d->ends_ns[chosen[k]] <= now_ns - d->lag_ns; k++) {
        int64_t start_ns = d->starts_ns[chosen[k]];
        PyObject *one = Py_BuildValue("nLL", chosen[k], (long long)(start_ns > decided_ns ? start_ns : decided_ns + 1),
                                      (long long)now_ns);
        int failed = one == NULL || PyList_Append(found, one) < 0;
        Py_XDECREF(one);
        if (failed)
            return -1;
        d->decided_ns = d->ends_ns[chosen[k]];
    }
    return 0;
}

PyDoc_STRVAR(decoded_doc,
    "decoded(starts_ns, ends_ns, gains, decisions_ns, restarts, lag_ns, memory_ns, overlap) -> list\n--\n\n"
    "Decide on candidates, in the order of their ends, as a Decoder does at each of the decisions' instants, of which\n"
    "some restart it: the number of each segment's candidate, its start and the instant of the decision (ns).");
static PyObject *decoded(PyObject *module, PyObject *args)
{
    Py_buffer b[5];
    long long lag_ns, memory_ns;
    double overlap;
    if (!PyArg_ParseTuple(args, "y*y*y*y*y*LLd", &b[0], &b[1], &b[2], &b[3], &b[4], &lag_ns, &memory_ns, &overlap))
        return NULL;
    Py_ssize_t count = b[0].len / 8, decisions = b[3].len / 8, next = 0;
    const int64_t *decisions_ns = b[3].buf;
    const uint8_t *restarts = b[4].buf;
    Py_ssize_t *room = PyMem_Malloc((4 * count + 4) * sizeof *room);
    double *best = PyMem_Malloc((count + 1) * sizeof *best);
    PyObject *found = PyList_New(0);
    if (room == NULL || best == NULL)
        PyErr_NoMemory();
    Decoding d = {lag_ns, memory_ns, -1, overlap, b[0].buf, b[1].buf, b[2].buf, room, 0, room + count + 1,
                  room + 2 * count + 2, best};
    for (Py_ssize_t k = 0; k < decisions && !PyErr_Occurred(); k++) {
        if (restarts[k])
            d.waiting = 0;
        if ((d.waiting || (next < count && d.ends_ns[next] == decisions_ns[k]))
            && decode_step(&d, decisions_ns[k], &next, count, room + 3 * count + 3, found) < 0)
            break;
    }
    PyMem_Free(room);
    PyMem_Free(best);
    for (int n = 0; n < 5; n++)
        PyBuffer_Release(&b[n]);
    if (PyErr_Occurred())
        Py_CLEAR(found);
    return found;
}

/* The responses of one kernel of -1 and 2 to an input that is 0 beyond its ends. */
VECTORISED static void respond(const float *input, const int8_t *kernel, int weights, int dilation, int instants, float *out)
{
    float padded[3 * MOST_INSTANTS] = {0};
    memcpy(padded + MOST_INSTANTS, input, instants * sizeof *input);
    for (int w = 0; w < weights; w++) {
        const float *from = padded + MOST_INSTANTS + (w - weights / 2) * dilation;
        float weight = kernel[w];
        for (int at = 0; at < instants; at++)
            out[at] = (w ? out[at] : 0.0f) + from[at] * weight;
    }
}

VECTORISED static int count_above(const float *response, float bias, const int32_t *counted, int instants)
{
    int count = 0;
    for (int at = 0; at < instants; at++)
        count += counted[at] & -(response[at] > bias);
    return count;
}

PyDoc_STRVAR(exceeding_doc,
    "exceeding(inputs, plain, kernels, dilations, weights, biases, counted, counts, out)\n--\n\n"
    "Write for each filter and each of its biases the share of the instants that count at which the response exceeds it.\n"
    "The filters behind the `plain` ones respond to how their inputs have just changed.");
static PyObject *exceeding(PyObject *module, PyObject *args)
{
    Py_buffer b[7];
    int weights;
    Py_ssize_t plain;
    if (!PyArg_ParseTuple(args, "y*ny*y*iy*y*y*w*", &b[0], &plain, &b[1], &b[2], &weights, &b[3], &b[4], &b[5], &b[6]))
        return NULL;
    const int8_t *kernels = b[1].buf;
    const int32_t *dilations = b[2].buf;
    const int32_t *counted = b[4].buf;
    const float *inputs = b[0].buf, *biases = b[3].buf, *counts = b[5].buf;
    float *out = b[6].buf, changes[MOST_INSTANTS] = {0}, response[MOST_INSTANTS];
    Py_ssize_t filters = b[5].len / (Py_ssize_t)sizeof(float), of_each = b[6].len / (Py_ssize_t)sizeof(float) / filters;
    Py_ssize_t kernel_count = b[1].len / weights;
    int instants = (int)(b[4].len / 4 / filters);
    if (instants > MOST_INSTANTS) {
        PyErr_SetString(PyExc_ValueError, "more instants than the compiled step has room for");
        return released(b, 7);
    }
    Py_BEGIN_ALLOW_THREADS
    for (Py_ssize_t f = 0; f < filters; f++) {
        const float *input = inputs + f * instants;
        for (int at = 1; at < instants; at++)
            changes[at] = input[at] - input[at - 1];
        respond(f < plain ? input : changes, kernels + f % kernel_count * weights, weights, dilations[f / kernel_count],
                instants, response);
        for (Py_ssize_t n = 0; n < of_each; n++)
            out[f * of_each + n]
                = (float)count_above(response, biases[f * of_each + n], counted + f * instants, instants) / counts[f];
    }
    Py_END_ALLOW_THREADS
    return released(b, 7);
}

/* Whether a number of some is unknown (NaN). */
static int has_unknown(const double *numbers, Py_ssize_t count)
{
    while (count-- > 0)
        if (isnan(numbers[count]))
            return 1;
    return 0;
}

/* Write joints as they lie between two postures, (45,), at a share of the time from one to the other, then those of the
   first joint of each pair from the other one, and their distances; each `apart` numbers behind the one before it. */
static void place(const double *before, const double *after, double share, const int32_t *pairs, Py_ssize_t count,
                  Py_ssize_t apart, float *out)
{
    for (int i = 0; i < COORDINATES; i++)
        out[i * apart] = (float)((1 - share) * before[i] + share * after[i]);
    float *from = out + COORDINATES * apart, *length = from + 3 * count * apart;
    for (Py_ssize_t k = 0; k < count; k++) {
        float d[3];
        for (int axis = 0; axis < 3; axis++) {
            d[axis] = out[(3 * pairs[2 * k] + axis) * apart] - out[(3 * pairs[2 * k + 1] + axis) * apart];
            from[(3 * k + axis) * apart] = d[axis];
        }
        length[k * apart] = sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    }
}

PyDoc_STRVAR(resampled_doc,
    "resampled(stamps_ns, postures, pairs, instants, out) -> bool\n--\n\n"
    "Write the coordinates of postures (n, 15, 3) at equal steps of time, (coordinates, instants). Return whether all\n"
    "were known; if not, nothing is written.");
static PyObject *resampled(PyObject *module, PyObject *args)
{
    Py_buffer b[4];
    Py_ssize_t instants;
    if (!PyArg_ParseTuple(args, "y*y*y*nw*", &b[0], &b[1], &b[2], &instants, &b[3]))
        return NULL;
    const Py_ssize_t last = b[0].len / (Py_ssize_t)sizeof(int64_t) - 1, pairs = b[2].len / (2 * (Py_ssize_t)sizeof(int32_t));
    const size_t bytes[4] = {sizeof(int64_t), COORDINATES * b[0].len, 0, (COORDINATES + 4 * pairs) * instants * sizeof(float)};
    const int64_t *ns = b[0].buf;
    const double *rows = b[1].buf;
    int is_known = are_long_enough(b, bytes, 4) && !has_unknown(rows, (last + 1) * COORDINATES);
    for (Py_ssize_t i = 0, k = 0; i < instants && is_known; i++) {
        double step = ((double)ns[last] - (double)ns[0]) / (double)(instants - 1);
        double at_ns = i < instants - 1 ? (double)i * step + (double)ns[0] : (double)ns[last];
        while (k < last && at_ns >= (double)ns[k + 1])
            k++;
        double since_ns = at_ns - (double)ns[k], at = (double)k;
        if (k < last && since_ns > 0)
            at = 1.0 / ((double)ns[k + 1] - (double)ns[k]) * since_ns + at;
        Py_ssize_t before = (Py_ssize_t)at < last ? (Py_ssize_t)at : last - 1;
        before = before < 0 ? 0 : before;
        const double *row = rows + before * COORDINATES;
        place(row, before < last ? row + COORDINATES : row, at - (double)before, b[2].buf, pairs, instants, (float *)b[3].buf + i);
    }
    Py_XDECREF(released(b, 4));
    return PyErr_Occurred() ? NULL : PyBool_FromLong(is_known);
}

/* Replace postures by their means over intervals (ns) of their stamps, and return how many these are. */
static Py_ssize_t average(const int64_t *ns, double *postures, Py_ssize_t n, int64_t interval_ns)
{
    Py_ssize_t count = 0, after;
    for (Py_ssize_t first = 0; first < n; first = after, count++) {
        for (after = first + 1; after < n && (ns[after] - ns[0]) / interval_ns == (ns[first] - ns[0]) / interval_ns;)
            after++;
        const double *from = postures + first * COORDINATES;
        for (int i = 0; i < COORDINATES; i++)
            postures[count * COORDINATES + i]
                = (from[i] + pairwise_sum_of_rows(from + COORDINATES + i, after - first - 1)) / (double)(after - first);
    }
    return count;
}

/* The mean of some joints' deviations from where they are on average in n postures. */
static double mean_deviation(const double *postures, Py_ssize_t n, const int32_t *joints, Py_ssize_t count)
{
    double summed = 0.0;
    for (Py_ssize_t k = 0; k < count; k++) {
        double variance = 0.0;
        for (int axis = 0; axis < 3; axis++) {
            const double *x = postures + 3 * joints[k] + axis;
            double mean = 0.0, squares = 0.0;
            for (Py_ssize_t i = 0; i < n; i++)
                mean += x[i * COORDINATES];
            mean /= (double)n;
            for (Py_ssize_t i = 0; i < n; i++)
                squares += (x[i * COORDINATES] - mean) * (x[i * COORDINATES] - mean);
            variance += squares / (double)n;
        }
        summed += sqrt(variance);
    }
    return summed / (double)count;
}

/* The squared distances between two postures of the two joints that are farthest apart, added up. */
static double farthest_apart2(const double *one, const double *other)
{
    double most = 0.0, second = 0.0;
    for (int joint = 0; joint < JOINTS; joint++) {
        double x = one[3 * joint] - other[3 * joint], y = one[3 * joint + 1] - other[3 * joint + 1];
        double z = one[3 * joint + 2] - other[3 * joint + 2], apart2 = x * x + y * y + z * z;
        second = apart2 > most ? most : apart2 > second ? apart2 : second;
        most = apart2 > most ? apart2 : most;
    }
    return most + second;
}

PyDoc_STRVAR(movements_doc,
    "movements(stamps_ns, postures, interval_ns, legs, trunk) -> (legs_m, trunk_m, moved_m) or None\n--\n\n"
    "Return how much the joints of the legs and of the trunk move in mean postures, and the distance between the two most\n"
    "different ones of these; None where a coordinate is unknown.");
static PyObject *movements(PyObject *module, PyObject *args)
{
    Py_buffer b[4];
    long long interval_ns;
    if (!PyArg_ParseTuple(args, "y*y*Ly*y*", &b[0], &b[1], &interval_ns, &b[2], &b[3]))
        return NULL;
    const size_t bytes[4] = {sizeof(int64_t), COORDINATES * b[0].len, sizeof(int32_t), sizeof(int32_t)};
    double *means = PyMem_Malloc(COORDINATES * b[0].len + 1), of_parts[2], moved2 = 0.0;
    if (means == NULL)
        PyErr_NoMemory();
    int is_known = !PyErr_Occurred() && are_long_enough(b, bytes, 4) && !has_unknown(b[1].buf, COORDINATES * b[0].len / 8);
    if (is_known) {
        memcpy(means, b[1].buf, COORDINATES * b[0].len);
        Py_ssize_t count = average(b[0].buf, means, b[0].len / (Py_ssize_t)sizeof(int64_t), interval_ns);
        for (int part = 0; part < 2; part++)
            of_parts[part] = mean_deviation(means, count, b[2 + part].buf, b[2 + part].len / (Py_ssize_t)sizeof(int32_t));
        for (Py_ssize_t i = 0; i < count; i++)
            for (Py_ssize_t k = 0; k < i; k++) {
                double apart2 = farthest_apart2(means + i * COORDINATES, means + k * COORDINATES);
                moved2 = apart2 > moved2 ? apart2 : moved2;
            }
    }
    PyMem_Free(means);
    PyObject *none = released(b, 4);
    if (none == NULL || !is_known)
        return none;
    Py_DECREF(none);
    return Py_BuildValue("ddd", of_parts[0], of_parts[1], sqrt(moved2 / 2));
}

/* A path: n stamps (ns), which rise, and n positions in metres, (n, 3). */
typedef struct {
    const double *ns, *m;
    Py_ssize_t count;
} Path;

static double squared_distance(const double *one, const double *other)
{
    double x = one[0] - other[0], y = one[1] - other[1], z = one[2] - other[2];
    return x * x + y * y + z * z;
}

/* The positions at some stamps, (n, 3): np.interp of each axis, constant beyond both ends. */
static void interpolate(const Path *path, const double *at_ns, Py_ssize_t n, double *out)
{
    Py_ssize_t k = 0;
    for (Py_ssize_t i = 0; i < n; i++, out += 3) {
        while (k > 0 && at_ns[i] < path->ns[k])
            k--;
        while (k + 1 < path->count && at_ns[i] >= path->ns[k + 1])
            k++;
        const double *before = path->m + 3 * k;
        int is_between = k + 1 < path->count && at_ns[i] > path->ns[k];
        for (int axis = 0; axis < 3; axis++)
            out[axis] = !is_between ? before[axis]
                : (before[axis + 3] - before[axis]) / (path->ns[k + 1] - path->ns[k]) * (at_ns[i] - path->ns[k])
                    + before[axis];
    }
}

PyDoc_STRVAR(interpolated_doc,
    "interpolated(at_ns, stamps_ns, positions_m, out)\n--\n\n"
    "Write where a path was at some stamps, (n, 3).");
static PyObject *interpolated(PyObject *module, PyObject *args)
{
    Py_buffer b[4];
    if (!PyArg_ParseTuple(args, "y*y*y*w*", &b[0], &b[1], &b[2], &b[3]))
        return NULL;
    const size_t bytes[4] = {0, sizeof(double), 3 * b[1].len, 3 * b[0].len};
    Path path = {b[1].buf, b[2].buf, b[1].len / sizeof(double)};
    if (are_long_enough(b, bytes, 4))
        interpolate(&path, b[0].buf, b[0].len / sizeof(double), b[3].buf);
    return released(b, 4);
}

PyDoc_STRVAR(bounds_doc,
    "bounds(positions_m, out)\n--\n\n"
    "Write the least and the greatest coordinates, (2, 3), of positions (n, 3), one at least.");
static PyObject *bounds(PyObject *module, PyObject *args)
{
    Py_buffer b[2];
    if (!PyArg_ParseTuple(args, "y*w*", &b[0], &b[1]))
        return NULL;
    const size_t bytes[2] = {3 * sizeof(double), 6 * sizeof(double)};
    if (!are_long_enough(b, bytes, 2))
        return released(b, 2);
    const double *positions = b[0].buf;
    double *least = b[1].buf, *greatest = least + 3;
    for (Py_ssize_t i = 0; i < b[0].len / (Py_ssize_t)sizeof(double) / 3 * 3; i++) {
        least[i % 3] = i < 3 || positions[i] < least[i % 3] ? positions[i] : least[i % 3];
        greatest[i % 3] = i < 3 || positions[i] > greatest[i % 3] ? positions[i] : greatest[i % 3];
    }
    return released(b, 2);
}

/* Average n positions, (n, 3), over some time around each, less near both ends; `sums` is room for (n + 1, 3). */
static void smooth(const Path *path, double within_ns, double *sums, double *out)
{
    Py_ssize_t first = 0, beyond = 0;
    memset(sums, 0, 3 * sizeof *sums);
    for (Py_ssize_t i = 0; i < 3 * path->count; i++)
        sums[i + 3] = sums[i] + path->m[i];
    for (Py_ssize_t i = 0; i < path->count; i++) {
        while (path->ns[first] < path->ns[i] - within_ns)
            first++;
        while (beyond < path->count && path->ns[beyond] <= path->ns[i] + within_ns)
            beyond++;
        Py_ssize_t half = i - first < beyond - 1 - i ? i - first : beyond - 1 - i;
        for (int axis = 0; axis < 3; axis++)
            out[3 * i + axis]
                = (sums[3 * (i + half + 1) + axis] - sums[3 * (i - half) + axis]) / (double)(2 * half + 1);
    }
}

PyDoc_STRVAR(smoothed_hand_doc,
    "smoothed_hand(stamps_ns, hands_m, hand, within_ns, out_ns, out_m) -> count\n--\n\n"
    "Write the stamps (n,) at which one of a person's hands, (n, 2, 3), is known, and its smooth positions, (n, 3).");
static PyObject *smoothed_hand(PyObject *module, PyObject *args)
{
    Py_buffer b[4];
    int hand;
    double within_ns;
    if (!PyArg_ParseTuple(args, "y*y*pdw*w*", &b[0], &b[1], &hand, &within_ns, &b[2], &b[3]))
        return NULL;
    const size_t all = b[0].len, bytes[4] = {0, 6 * all, all, 3 * all};
    const double *stamps_ns = b[0].buf, *hands_m = b[1].buf;
    double *known_ns = b[2].buf, *known_m = PyMem_Malloc((6 * all + 3 * sizeof(double)));
    Path known = {known_ns, known_m, 0};
    if (known_m == NULL)
        PyErr_NoMemory();
    else if (are_long_enough(b, bytes, 4)) {
        for (size_t i = 0; i < all / sizeof(double); i++)
            if (isfinite(hands_m[6 * i + 3 * hand])) {
                known_ns[known.count] = stamps_ns[i];
                memcpy(known_m + 3 * known.count++, hands_m + 6 * i + 3 * hand, 3 * sizeof(double));
            }
        smooth(&known, within_ns, known_m + 3 * known.count, b[3].buf);
    }
    PyMem_Free(known_m);
    Py_XDECREF(released(b, 4));
    return PyErr_Occurred() ? NULL : PyLong_FromSsize_t(known.count);
}

/* The last of the positions `first` to `now` that is about as far from the one now as any of them; -1 where none is
   `moved_m` away. */
static Py_ssize_t furthest_away(const double *positions, Py_ssize_t first, Py_ssize_t now, double share, double moved_m)
{
    double most2 = 0.0;
    for (Py_ssize_t k = first; k < now; k++) {
        double away2 = squared_distance(positions + 3 * k, positions + 3 * now);
        most2 = away2 > most2 ? away2 : most2;
    }
    double least = share * sqrt(most2);
    if (sqrt(most2) < moved_m)
        return -1;
    Py_ssize_t last = now;
    while (last > first && sqrt(squared_distance(positions + 3 * last, positions + 3 * now)) < least)
        last--;
    return last;
}

/* What a motion is compared by: times (ns), distances (m) and shares, as `comotion` is given them. */
typedef struct {
    double step_ns, recent_ns, share, reach_m, moved_m, unexplained;
} Limits;

/* Mark at each instant of a hand whether an object is near, in motion, and moved by the hand, (3, n). */
static void mark(const Path *hand, const double *object, const double *apart, const Limits *limits, char *near)
{
    Py_ssize_t n = hand->count, first = 0, recent = 0;
    char *in_motion = near + n, *with_hand = in_motion + n;
    while (recent < n && hand->ns[recent] < limits->recent_ns)
        recent++;
    for (Py_ssize_t i = 0; i < n; i++) {
        near[i] = apart[i] <= limits->reach_m;
        in_motion[i] = with_hand[i] = 0;
        while (hand->ns[first] < hand->ns[i] - limits->step_ns)
            first++;
        Py_ssize_t since = near[i] ? furthest_away(object, first, i, limits->share, limits->moved_m) : -1;
        if (since < 0)
            continue;
        if (since < recent && recent <= i)
            since = recent;
        double step[3], hand_step[3];
        for (int axis = 0; axis < 3; axis++) {
            step[axis] = object[3 * i + axis] - object[3 * since + axis];
            hand_step[axis] = hand->m[3 * i + axis] - hand->m[3 * since + axis];
        }
        double origin[3] = {0}, moved2 = squared_distance(step, origin);
        in_motion[i] = sqrt(moved2) >= limits->moved_m;
        with_hand[i] = in_motion[i] && squared_distance(step, hand_step) < limits->unexplained * moved2;
    }
}

PyDoc_STRVAR(comotion_doc,
    "comotion(hand_ns, hand_m, object_ns, object_m, step_ns, recent_ns, share, reach_m, moved_m, unexplained, out, marks)\n"
    "--\n\n"
    "Write at each of a hand's n instants where an object is, (n, 3), the vector to it from the hand, (n, 3), its length,\n"
    "(n,), and the object's path since the previous instant, (n,); and mark whether the object is near, in motion, and\n"
    "moved by the hand, (3, n).");
static PyObject *comotion(PyObject *module, PyObject *args)
{
    Py_buffer b[6];
    Limits limits;
    if (!PyArg_ParseTuple(args, "y*y*y*y*ddddddw*w*", &b[0], &b[1], &b[2], &b[3], &limits.step_ns, &limits.recent_ns,
                          &limits.share, &limits.reach_m, &limits.moved_m, &limits.unexplained, &b[4], &b[5]))
        return NULL;
    const size_t all = b[0].len, n = all / sizeof(double);
    const size_t bytes[6] = {0, 3 * all, sizeof(double), 3 * b[2].len, 8 * all, 3 * n};
    Path hand = {b[0].buf, b[1].buf, n}, object = {b[2].buf, b[3].buf, b[2].len / sizeof(double)};
    if (!are_long_enough(b, bytes, 6))
        return released(b, 6);
    double *positions = b[4].buf, *offsets = positions + 3 * n, *apart = offsets + 3 * n, *moved = apart + n;
    interpolate(&object, hand.ns, n, positions);
    for (size_t i = 0; i < 3 * n; i++)
        offsets[i] = positions[i] - hand.m[i];
    for (size_t i = 0; i < n; i++) {
        apart[i] = length3(offsets + 3 * i);
        moved[i] = i ? sqrt(squared_distance(positions + 3 * i, positions + 3 * i - 3)) : 0.0;
    }
    mark(&hand, positions, apart, &limits, b[5].buf);
    return released(b, 6);
}

PyDoc_STRVAR(closings_doc,
    "closings(hand_m, instants, step_m, object_m, distances_m, out)\n--\n\n"
    "Write by which share of its last step of `step_m` or more a hand came nearer to an object until some instants, (n,).");
static PyObject *closings(PyObject *module, PyObject *args)
{
    Py_buffer b[5];
    double step_m;
    if (!PyArg_ParseTuple(args, "y*y*dy*y*w*", &b[0], &b[1], &step_m, &b[2], &b[3], &b[4]))
        return NULL;
    const size_t n = b[1].len, all = n * sizeof(double), bytes[5] = {3 * all, 0, 3 * all, all, all};
    if (!are_long_enough(b, bytes, 5))
        return released(b, 5);
    const char *asked = b[1].buf;
    const double *hand = b[0].buf, *object = b[2].buf, *apart = b[3].buf;
    double *out = b[4].buf;
    for (size_t i = 0; i < n; i++) {
        size_t since = asked[i] ? i : 0;
        double step = 0.0;
        while (since > 0 && (step = sqrt(squared_distance(hand + 3 * --since, hand + 3 * i))) < step_m)
            step = 0.0;
        double share = step > 0 ? (sqrt(squared_distance(object + 3 * i, hand + 3 * since)) - apart[i]) / step : 0.0;
        out[i] = share < 0.0 ? 0.0 : share > 1.0 ? 1.0 : share;
    }
    return released(b, 5);
}

/* Steps of sequential training of a map whose weights are (dim, stride): each moves the units around an input's winner
   towards the input. The same pass adds up the distances to the next input, each sum component after component, of four
   components at a time unless one is missing (NaN). */
typedef struct {
    void *weights;
    const void *inputs, *over_rows, *over_cols;
    Py_ssize_t steps, dim, stride, rows, cols;
} Learning;

#define LEARNING(REAL)                                                                                                     \
VECTORISED static void pull_four_##REAL(REAL *restrict weights, Py_ssize_t stride, const REAL *x, const REAL *next,        \
                                        const REAL *restrict share, REAL *restrict distances2)                             \
{                                                                                                                          \
    for (Py_ssize_t unit = 0; unit < stride; unit++) {                                                                     \
        REAL distance2 = distances2[unit];                                                                                 \
        for (int d = 0; d < 4; d++) {                                                                                      \
            REAL weight = weights[d * stride + unit] + (x[d] - weights[d * stride + unit]) * share[unit];                  \
            weights[d * stride + unit] = weight;                                                                           \
            distance2 += (next[d] - weight) * (next[d] - weight);                                                          \
        }                                                                                                                  \
        distances2[unit] = distance2;                                                                                      \
    }                                                                                                                      \
}                                                                                                                          \
/* pull the weights towards x, where there is one, then measure their distances to the next input */                       \
VECTORISED static void pull_##REAL(const Learning *l, const REAL *x, const REAL *next, const REAL *share,                  \
                                   REAL *restrict distances2)                                                              \
{                                                                                                                          \
    Py_ssize_t d = 0, known = x != NULL;                                                                                   \
    for (Py_ssize_t i = 0; i < l->dim && known; i++)                                                                       \
        known = x[i] == x[i] && next[i] == next[i];                                                                        \
    memset(distances2, 0, l->stride * sizeof(REAL));                                                                       \
    for (; known && d + 4 <= l->dim; d += 4)                                                                               \
        pull_four_##REAL((REAL *)l->weights + d * l->stride, l->stride, x + d, next + d, share, distances2);               \
    for (; d < l->dim; d++) {                                                                                              \
        REAL *restrict weights = (REAL *)l->weights + d * l->stride;                                                       \
        for (Py_ssize_t unit = 0; unit < l->stride && x != NULL && x[d] == x[d]; unit++)                                   \
            weights[unit] += (x[d] - weights[unit]) * share[unit];                                                         \
        for (Py_ssize_t unit = 0; unit < l->stride && next[d] == next[d]; unit++)                                          \
            distances2[unit] += (next[d] - weights[unit]) * (next[d] - weights[unit]);                                     \
    }                                                                                                                      \
}                                                                                                                          \
VECTORISED static Py_ssize_t winner_##REAL(const REAL *distances2, Py_ssize_t units)                                       \
{                                                                                                                          \
    Py_ssize_t unit = 0;                                                                                                   \
    REAL of_lane[LANES], least = distances2[0];                                                                            \
    for (int lane = 0; lane < LANES; lane++)                                                                               \
        of_lane[lane] = least;                                                                                             \
    for (; unit + LANES <= units; unit += LANES)                                                                           \
        for (int lane = 0; lane < LANES; lane++)                                                                           \
            of_lane[lane] = distances2[unit + lane] < of_lane[lane] ? distances2[unit + lane] : of_lane[lane];             \
    for (; unit < units; unit++)                                                                                           \
        least = distances2[unit] < least ? distances2[unit] : least;                                                       \
    for (int lane = 0; lane < LANES; lane++)                                                                               \
        least = of_lane[lane] < least ? of_lane[lane] : least;                                                             \
    for (unit = 0; unit < units - 1 && distances2[unit] != least;)                                                         \
        unit++;                                                                                                            \
    return unit;                                                                                                           \
}                                                                                                                          \
static void learn_##REAL(const Learning *l, REAL *share, REAL *distances2)                                                 \
{                                                                                                                          \
    const REAL *x = l->inputs, *over_rows = l->over_rows, *over_cols = l->over_cols;                                       \
    pull_##REAL(l, NULL, x, NULL, distances2);                                                                             \
    for (Py_ssize_t step = 0; step < l->steps; step++, x += l->dim, over_rows += l->rows, over_cols += l->cols) {          \
        Py_ssize_t winner = winner_##REAL(distances2, l->rows * l->cols);                                                  \
        for (Py_ssize_t row = 0; row < l->rows; row++)                                                                     \
            for (Py_ssize_t col = 0; col < l->cols; col++)                                                                 \
                share[row * l->cols + col] = over_rows[Py_ABS(row - winner / l->cols)]                                     \
                                             * over_cols[Py_ABS(col - winner % l->cols)];                                  \
        pull_##REAL(l, x, step + 1 < l->steps ? x + l->dim : x, share, distances2);                                        \
    }                                                                                                                      \
}

LEARNING(float)
LEARNING(double)

PyDoc_STRVAR(learned_doc,
    "learned(weights, inputs, over_rows, over_cols, steps, itemsize)\n--\n\n"
    "Take all steps of `actum.som.kernel.adapt_in_numpy`, in place, with numbers of so many bytes.");
static PyObject *learned(PyObject *module, PyObject *args)
{
    Py_buffer b[4];
    Py_ssize_t itemsize;
    Learning l;
    if (!PyArg_ParseTuple(args, "w*y*y*y*nn", &b[0], &b[1], &b[2], &b[3], &l.steps, &itemsize))
        return NULL;
    if (itemsize != sizeof(float) && itemsize != sizeof(double)) {
        PyErr_SetString(PyExc_ValueError, "the numbers have neither single nor double precision");
        return released(b, 4);
    }
    Py_ssize_t row = itemsize * (l.steps > 0 ? l.steps : 1);
    l.weights = b[0].buf, l.inputs = b[1].buf, l.over_rows = b[2].buf, l.over_cols = b[3].buf;
    l.dim = b[1].len / row, l.rows = b[2].len / row, l.cols = b[3].len / row;
    l.stride = l.dim ? b[0].len / itemsize / l.dim : 0;
    char *scratch = PyMem_Calloc(2 * l.stride + 1, itemsize);
    if (scratch == NULL)
        PyErr_NoMemory();
    else if (l.steps <= 0 || !l.rows || !l.cols || l.rows * l.cols > l.stride)
        PyErr_SetString(PyExc_ValueError, "there is no step, or the map has more units than the weights have columns");
    else {
        Py_BEGIN_ALLOW_THREADS
        if (itemsize == sizeof(float))
            learn_float(&l, (float *)scratch, (float *)scratch + l.stride);
        else
            learn_double(&l, (double *)scratch, (double *)scratch + l.stride);
        Py_END_ALLOW_THREADS
    }
    PyMem_Free(scratch);
    return released(b, 4);
}

static PyMethodDef methods[] = {
    {"adapted", adapted, METH_VARARGS, adapted_doc},
    {"added", added, METH_VARARGS, added_doc},
    {"added_frames", added_frames, METH_VARARGS, added_frames_doc},
    {"body", body, METH_VARARGS, body_doc},
    {"bounds", bounds, METH_VARARGS, bounds_doc},
    {"centred", centred, METH_VARARGS, centred_doc},
    {"closings", closings, METH_VARARGS, closings_doc},
    {"comotion", comotion, METH_VARARGS, comotion_doc},
    {"contrasted", contrasted, METH_VARARGS, contrasted_doc},
    {"decoded", decoded, METH_VARARGS, decoded_doc},
    {"exceeding", exceeding, METH_VARARGS, exceeding_doc},
    {"exponents", exponents, METH_VARARGS, exponents_doc},
    {"interpolated", interpolated, METH_VARARGS, interpolated_doc},
    {"learned", learned, METH_VARARGS, learned_doc},
    {"left_arm_acts", left_arm_acts, METH_VARARGS, left_arm_acts_doc},
    {"movements", movements, METH_VARARGS, movements_doc},
    {"plain_joints_or", (PyCFunction)(void (*)(void))plain_joints_or, METH_FASTCALL, plain_joints_or_doc},
    {"pooled", pooled, METH_VARARGS, pooled_doc},
    {"pooled_windows", pooled_windows, METH_VARARGS, pooled_windows_doc},
    {"posture", posture, METH_VARARGS, posture_doc},
    {"resampled", resampled, METH_VARARGS, resampled_doc},
    {"running_sums", running_sums, METH_VARARGS, running_sums_doc},
    {"smoothed", smoothed, METH_VARARGS, smoothed_doc},
    {"smoothed_hand", smoothed_hand, METH_VARARGS, smoothed_hand_doc},
    {"spreads", spreads, METH_VARARGS, spreads_doc},
    {"usable", usable, METH_VARARGS, usable_doc},
    {NULL, NULL, 0, NULL},
};
/* Say of which source this was compiled: a library of another one does not go with the Python code beside it. */
static int name_source(PyObject *module) { return PyModule_AddStringConstant(module, "source", SOURCE); }

static PyModuleDef_Slot slots[] = {{Py_mod_exec, name_source}, {0, NULL}};
static struct PyModuleDef definition = {PyModuleDef_HEAD_INIT, "actum._compiled", NULL, 0, methods, slots, NULL, NULL, NULL};

PyMODINIT_FUNC PyInit__compiled(void) { return PyModuleDef_Init(&definition); }
