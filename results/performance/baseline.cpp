// The benchmark's baseline: the same rows and summaries, written by hand for each machine.
//
// Straight-line dyad formulas with square root and division only, one table of cosines and sines, everything that
// depends only on the variant moved out of the loop over positions, that loop vectorised, variants divided among
// the threads. Built by benchmark.py with -O3 -march=native -ffast-math -fopenmp.

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

// Otherwise the compiler leaves calls inside the loop over positions of the larger machines.
#define INLINE inline __attribute__((always_inline))

namespace {

struct Vec {
    double x, y;
};

INLINE Vec operator+(Vec a, Vec b) { return {a.x + b.x, a.y + b.y}; }
INLINE Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y}; }
INLINE Vec operator*(double s, Vec a) { return {s * a.x, s * a.y}; }
INLINE double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y; }
INLINE Vec left(Vec a) { return {-a.y, a.x}; }

// A point of a link, in units of the vector between the link's joints: along it and to its left.
struct Place {
    double along, across;
    Place(double x, double y, double length) : along(x / length), across(y / length) {}
    INLINE Vec of(Vec link) const { return {along * link.x - across * link.y, along * link.y + across * link.x}; }
};

struct Body {
    double mass, inertia, weight;
    Place centre;
    Body(double m, double x, double y, double j, double gravity, double length)
        : mass(m), inertia(j), weight(m * gravity), centre(x, y, length) {}
};

INLINE double cross(Vec a, Vec b) { return a.x * b.y - a.y * b.x; }

// A force on a link and its moment about the link's first joint.
struct Load {
    Vec force{0.0, 0.0};
    double moment = 0.0;
    INLINE void push(Vec f, Vec arm) {
        force = force + f;
        moment += cross(arm, f);
    }
};

// Weight and inertia force of a body, for the speed of the crank.
struct Heavy {
    double mass, inertia, weight;
    Heavy(const Body& b, double square) : mass(b.mass * square), inertia(b.inertia * square), weight(b.weight) {}
    INLINE void load(Load& on, Vec a, double e, Vec arm) const {
        on.push({-mass * a.x, -mass * a.y - weight}, arm);
        on.moment -= inertia * e;
    }
};

// `way` is the position of the output: the slide, or the direction of the rocker.
struct Reduced {
    double inertia, slope, moment;
    Vec way{0.0, 0.0};
    INLINE void add(const Body& b, Vec v, Vec a, double w, double e) {
        inertia += b.mass * dot(v, v) + b.inertia * (w * w);
        slope += 2.0 * (b.mass * dot(v, a) + b.inertia * (w * e));
        moment -= b.weight * v.y;
    }
};

// Dyad RRR between joints whose velocities and accelerations are given: the two link vectors and their rates.
struct RRR {
    double sum2, difference2, product, mode;
    RRR(double r1, double r2, double m)
        : sum2((r1 + r2) * (r1 + r2)), difference2((r1 - r2) * (r1 - r2)), product(r1 * r1 - r2 * r2), mode(m) {}

    struct State {
        Vec p1, p2;
        double w1, w2, e1, e2, scale;
    };

    struct Forces {
        Vec a, b, d;
    };

    INLINE void position(Vec l, Vec& p1, Vec& p2, double& root) const {
        double d2 = dot(l, l), half = 0.5 / d2;
        root = mode * std::sqrt((sum2 - d2) * (d2 - difference2));
        double p = half * (product + d2), h = half * root;
        p1 = {p * l.x - h * l.y, p * l.y + h * l.x};
        p2 = p1 - l;
    }

    INLINE State solve(Vec a, Vec d, Vec va, Vec vd, Vec aa, Vec ad) const {
        State s;
        double root;
        position(d - a, s.p1, s.p2, root);
        double scale = s.scale = 2.0 / root;
        Vec g = vd - va;
        s.w1 = scale * dot(g, s.p2);
        s.w2 = scale * dot(g, s.p1);
        g = ad - aa + (s.w1 * s.w1) * s.p1 - (s.w2 * s.w2) * s.p2;
        s.e1 = scale * dot(g, s.p2);
        s.e2 = scale * dot(g, s.p1);
        return s;
    }

    INLINE static Forces reactions(const State& s, const Load& one, const Load& two) {
        Vec b = -s.scale * (two.moment * s.p1 + one.moment * s.p2);
        return {-1.0 * one.force - b, b, b - two.force};
    }
};

INLINE Vec velocity(Vec v, double w, Vec arm) { return v + w * left(arm); }
INLINE Vec acceleration(Vec a, double w, double e, Vec arm) { return a + e * left(arm) - (w * w) * arm; }

// Parameters come in the order that benchmark.py lists for each machine.

struct SliderCrank {
    static constexpr bool ROCKS = false;
    Vec o, guide, u, force;
    double r, l, offset, mode, moment, crank_inertia;
    Body crank, rod, ram;
    explicit SliderCrank(const double* p)
        : o{p[1], p[2]}, guide{p[3], p[4]}, u{std::cos(p[5]), std::sin(p[5])},
          force{p[22] * std::cos(p[21]), p[22] * std::sin(p[21])}, r(p[6]), l(p[7]), offset(p[8]), mode(p[9]),
          moment(p[23]), crank_inertia(p[10] * (p[11] * p[11] + p[12] * p[12]) + p[13]),
          crank(p[10], p[11], p[12], p[13], p[0], p[6]), rod(p[14], p[15], p[16], p[17], p[0], p[7]),
          ram(p[18], p[19], p[20], 0.0, p[0], 1.0) {}

    INLINE Reduced at(double c, double s) const {
        Vec arm{r * c, r * s}, va = left(arm);
        Vec from = o + arm - guide;
        double across = u.x * from.y - u.y * from.x - offset;
        double root = mode * std::sqrt((l - across) * (l + across));
        Vec p{root * u.x + across * u.y, root * u.y - across * u.x};
        // w k x p - slide u = -va and its derivative; the component across the guide gives w, p the slide.
        double over = 1.0 / root;
        double w = over * (u.y * va.x - u.x * va.y);
        double slide = dot(va, p) * over;
        Vec g = arm + (w * w) * p;
        double e = over * (u.x * g.y - u.y * g.x);
        double slide2 = -over * dot(g, p);
        Vec vb = slide * u, ab = slide2 * u;
        Reduced out{crank_inertia, 0.0, -crank.weight * crank.centre.of(arm).x};
        Vec centre = rod.centre.of(p);
        out.add(rod, velocity(va, w, centre), acceleration(Vec{-arm.x, -arm.y}, w, e, centre), w, e);
        out.add(ram, vb, ab, 0.0, 0.0);
        out.moment += dot(force, vb) + moment;
        out.way = {u.x * from.x + u.y * from.y + root, slide};
        return out;
    }
};

// A slider-crank whose ram works over the last part of its stroke, towards the high end.
struct Press : SliderCrank {
    static constexpr double DEPTH = 0.02, FORCE = -4000.0;
    double begin, work;
    explicit Press(const double* p) : SliderCrank(p) {
        const Vec from = o - guide;
        const double across = u.x * from.y - u.y * from.x - offset, reach = l + r;
        begin = dot(u, from) + std::sqrt((reach + across) * (reach - across)) - DEPTH;
        work = FORCE * p[24];
    }

    INLINE Reduced at(double c, double s) const {
        Reduced out = SliderCrank::at(c, s);
        out.moment += out.way.x > begin && out.way.y > 0.0 ? work * out.way.y : 0.0;
        return out;
    }
};

struct FourBar {
    static constexpr bool ROCKS = true;
    Vec o, d, force;
    double r, moment, crank_inertia, over_rocker;
    RRR dyad;
    Place point;
    Body crank, rod, rocker;
    explicit FourBar(const double* p)
        : o{p[1], p[2]}, d{p[3], p[4]}, force{p[24] * std::cos(p[23]), p[24] * std::sin(p[23])}, r(p[5]),
          moment(p[25]), crank_inertia(p[9] * (p[10] * p[10] + p[11] * p[11]) + p[12]), over_rocker(1.0 / p[7]),
          dyad(p[6], p[7], p[8]),
          point(p[21], p[22], p[6]), crank(p[9], p[10], p[11], p[12], p[0], p[5]),
          rod(p[13], p[14], p[15], p[16], p[0], p[6]), rocker(p[17], p[18], p[19], p[20], p[0], p[7]) {}

    INLINE Reduced at(double c, double s) const {
        Vec arm{r * c, r * s}, va = left(arm), aa{-arm.x, -arm.y}, rest{0.0, 0.0};
        RRR::State g = dyad.solve(o + arm, d, va, rest, aa, rest);
        Reduced out{crank_inertia, 0.0, -crank.weight * crank.centre.of(arm).x};
        Vec centre = rod.centre.of(g.p1);
        out.add(rod, velocity(va, g.w1, centre), acceleration(aa, g.w1, g.e1, centre), g.w1, g.e1);
        centre = rocker.centre.of(g.p2);
        out.add(rocker, velocity(rest, g.w2, centre), acceleration(rest, g.w2, g.e2, centre), g.w2, g.e2);
        out.moment += dot(force, velocity(va, g.w1, point.of(g.p1))) + moment * g.w2;
        out.way = over_rocker * g.p2;
        return out;
    }
};

struct SixBar {
    static constexpr bool ROCKS = true;
    Vec o, d, e, force;
    double r, moment, crank_inertia, over_lever;
    RRR first, second;
    Place point;
    Body crank, rod, rocker, bar, lever;
    explicit SixBar(const double* p)
        : o{p[1], p[2]}, d{p[3], p[4]}, e{p[5], p[6]}, force{p[37] * std::cos(p[36]), p[37] * std::sin(p[36])},
          r(p[7]), moment(p[38]), crank_inertia(p[14] * (p[15] * p[15] + p[16] * p[16]) + p[17]),
          over_lever(1.0 / p[12]), first(p[8], p[9], p[10]), second(p[11], p[12], p[13]), point(p[34], p[35], p[9]),
          crank(p[14], p[15], p[16], p[17], p[0], p[7]), rod(p[18], p[19], p[20], p[21], p[0], p[8]),
          rocker(p[22], p[23], p[24], p[25], p[0], p[9]), bar(p[26], p[27], p[28], p[29], p[0], p[11]),
          lever(p[30], p[31], p[32], p[33], p[0], p[12]) {}

    INLINE Reduced at(double c, double s) const {
        Vec arm{r * c, r * s}, va = left(arm), aa{-arm.x, -arm.y}, rest{0.0, 0.0};
        RRR::State g = first.solve(o + arm, d, va, rest, aa, rest);
        Vec out_arm = point.of(g.p2), vc = g.w2 * left(out_arm);
        Vec ac = acceleration(rest, g.w2, g.e2, out_arm);
        RRR::State h = second.solve(d + out_arm, e, vc, rest, ac, rest);
        Reduced out{crank_inertia, 0.0, -crank.weight * crank.centre.of(arm).x};
        Vec centre = rod.centre.of(g.p1);
        out.add(rod, velocity(va, g.w1, centre), acceleration(aa, g.w1, g.e1, centre), g.w1, g.e1);
        centre = rocker.centre.of(g.p2);
        out.add(rocker, velocity(rest, g.w2, centre), acceleration(rest, g.w2, g.e2, centre), g.w2, g.e2);
        centre = bar.centre.of(h.p1);
        out.add(bar, velocity(vc, h.w1, centre), acceleration(ac, h.w1, h.e1, centre), h.w1, h.e1);
        centre = lever.centre.of(h.p2);
        out.add(lever, velocity(rest, h.w2, centre), acceleration(rest, h.w2, h.e2, centre), h.w2, h.e2);
        out.moment += dot(force, h.w2 * left(h.p2)) + moment * h.w2;
        out.way = over_lever * h.p2;
        return out;
    }
};

// Reactions in all pairs of the six-bar and the moment on its crank: x and y of each force, on the link that comes
// later from the one before it, in the inner joints on the first link of a dyad.
struct SixBarForces {
    static constexpr int ROWS = 15;
    SixBar bar;
    Heavy crank, rod, rocker, second_bar, lever;
    SixBarForces(const double* p, double omega)
        : bar(p), crank(bar.crank, omega * omega), rod(bar.rod, omega * omega), rocker(bar.rocker, omega * omega),
          second_bar(bar.bar, omega * omega), lever(bar.lever, omega * omega) {}

    INLINE void at(double c, double s, double* __restrict out, long stride) const {
        Vec arm{bar.r * c, bar.r * s}, va = left(arm), aa{-arm.x, -arm.y}, rest{0.0, 0.0};
        RRR::State g = bar.first.solve(bar.o + arm, bar.d, va, rest, aa, rest);
        Vec out_arm = bar.point.of(g.p2), vc = g.w2 * left(out_arm);
        Vec ac = acceleration(rest, g.w2, g.e2, out_arm);
        RRR::State h = bar.second.solve(bar.d + out_arm, bar.e, vc, rest, ac, rest);
        Load on_crank, on_rod, on_rocker, on_bar, on_lever;
        Vec centre = bar.bar.centre.of(h.p1);
        second_bar.load(on_bar, acceleration(ac, h.w1, h.e1, centre), h.e1, centre);
        on_bar.push(bar.force, h.p1);
        centre = bar.lever.centre.of(h.p2);
        lever.load(on_lever, acceleration(rest, h.w2, h.e2, centre), h.e2, centre);
        on_lever.moment += bar.moment;
        RRR::Forces second = RRR::reactions(h, on_bar, on_lever);
        centre = bar.rod.centre.of(g.p1);
        rod.load(on_rod, acceleration(aa, g.w1, g.e1, centre), g.e1, centre);
        centre = bar.rocker.centre.of(g.p2);
        rocker.load(on_rocker, acceleration(rest, g.w2, g.e2, centre), g.e2, centre);
        on_rocker.push(-1.0 * second.a, out_arm);
        RRR::Forces first = RRR::reactions(g, on_rod, on_rocker);
        centre = bar.crank.centre.of(arm);
        crank.load(on_crank, -1.0 * centre, 0.0, centre);
        on_crank.push(-1.0 * first.a, arm);
        const Vec forces[7] = {-1.0 * on_crank.force, first.a, first.b, first.d, second.a, second.b, second.d};
        for (int i = 0; i < 7; ++i) {
            out[2 * i * stride] = forces[i].x;
            out[(2 * i + 1) * stride] = forces[i].y;
        }
        out[14 * stride] = -on_crank.moment;
    }
};

template <class Machine>
void fields(const double* parameters, int count, int variants, int n, const double* cosines, const double* sines,
            double* inertia, double* slope, double* moment) {
#pragma omp parallel for schedule(static)
    for (int v = 0; v < variants; ++v) {
        const Machine machine(parameters + static_cast<long>(v) * count);
        const long at = static_cast<long>(v) * n;
        double* __restrict i_row = inertia + at;
        double* __restrict s_row = slope + at;
        double* __restrict m_row = moment + at;
#pragma omp simd
        for (int k = 0; k < n; ++k) {
            const Reduced r = machine.at(cosines[k], sines[k]);
            i_row[k] = r.inertia;
            s_row[k] = r.slope;
            m_row[k] = r.moment;
        }
    }
}

double mean_of(const double* __restrict row, int n) {
    double total = 0.0;
#pragma omp simd reduction(+ : total)
    for (int k = 0; k < n; ++k) total += row[k];
    return total / n;
}

struct Sizes {
    double drive, excess, by_excess, merzalov, wittenbauer;
};

// Flywheel sizes from the rows of I and M, the work being accumulated by the trapezoid rule.
Sizes flywheel_sizes(const double* __restrict inertia, const double* __restrict moment, double* __restrict work, int n,
                     double h, double omega, double delta, double first_kind) {
    const double mean = mean_of(moment, n);
    double sum = 0.0;
    work[0] = 0.0;
    for (int k = 1; k < n; ++k) {
        sum += 0.5 * h * (moment[k - 1] + moment[k] - 2.0 * mean);
        work[k] = sum;
    }
    const double middle = 0.5 * omega * omega;
    const double fast = middle * (1.0 + 0.5 * delta) * (1.0 + 0.5 * delta);
    const double slow = middle * (1.0 - 0.5 * delta) * (1.0 - 0.5 * delta);
    double w_max = work[0], w_min = work[0], m_max = work[0] - middle * inertia[0], m_min = m_max;
    double top = work[0] - fast * inertia[0], bottom = work[0] - slow * inertia[0];
#pragma omp simd reduction(max : w_max, m_max, top) reduction(min : w_min, m_min, bottom)
    for (int k = 0; k < n; ++k) {
        const double w = work[k], i = inertia[k];
        w_max = std::max(w_max, w);
        w_min = std::min(w_min, w);
        m_max = std::max(m_max, w - middle * i);
        m_min = std::min(m_min, w - middle * i);
        top = std::max(top, w - fast * i);
        bottom = std::min(bottom, w - slow * i);
    }
    const double scale = 1.0 / (delta * omega * omega);
    return {-mean, w_max - w_min, scale * (w_max - w_min), scale * (m_max - m_min) - first_kind,
            scale * (top - bottom)};
}

INLINE double sixth_difference(const double* row, int a, int b, int c, int d, int e, int f, int g) {
    return row[a] + row[g] - 6.0 * (row[b] + row[f]) + 15.0 * (row[c] + row[e]) - 20.0 * row[d];
}

// Possible error of the work from jumps of the moment between two positions.
double jump_work(const double* __restrict moment, int n, double h) {
    double total = 0.0;
#pragma omp simd reduction(+ : total)
    for (int k = 0; k < n - 6; ++k) {
        const double d = sixth_difference(moment, k, k + 1, k + 2, k + 3, k + 4, k + 5, k + 6);
        total += d * d;
    }
    for (int k = n - 6; k < n; ++k) {
        const double d = sixth_difference(moment, k, (k + 1) % n, (k + 2) % n, (k + 3) % n, (k + 4) % n, (k + 5) % n,
                                          (k + 6) % n);
        total += d * d;
    }
    return 0.5 * h * std::sqrt(total / 252.0);
}

// Possible excess of an extreme of the energy over those at the positions.
double missed_extreme(const double* __restrict inertia, const double* __restrict work, int n, double slope) {
    double worst = 0.0;
#pragma omp simd reduction(max : worst)
    for (int k = 1; k < n - 1; ++k) {
        const double here = work[k] - slope * inertia[k];
        const double before = work[k - 1] - slope * inertia[k - 1], after = work[k + 1] - slope * inertia[k + 1];
        worst = std::max(worst, std::abs(before - 2.0 * here + after));
    }
    const double before = work[n - 2] - slope * inertia[n - 2], last = work[n - 1] - slope * inertia[n - 1];
    const double first = work[0] - slope * inertia[0], second = work[1] - slope * inertia[1];
    worst = std::max({worst, std::abs(before - 2.0 * last + first), std::abs(last - 2.0 * first + second)});
    return 0.125 * worst;
}

// Range of a row, and its possible error: against half the positions, and between two positions.
struct Extent {
    double low, high, missed, halved;
};

INLINE Extent extent(const double* __restrict row, int n) {
    double low = row[0], high = row[0], half_low = row[0], half_high = row[0];
#pragma omp simd reduction(max : high) reduction(min : low)
    for (int k = 0; k < n; ++k) {
        low = std::min(low, row[k]);
        high = std::max(high, row[k]);
    }
    for (int k = 0; k < n; k += 2) {
        half_low = std::min(half_low, row[k]);
        half_high = std::max(half_high, row[k]);
    }
    return {low, high, missed_extreme(row, row, n, 0.0), std::max(half_low - low, high - half_high)};
}

// Required drive moment and power, excess work, three flywheels, fluctuation of speed, stroke or swing, peak of the
// input moment.
constexpr int SUMMARIES = 9;

template <class Machine>
void summaries(const double* parameters, int count, int variants, int n, const double* cosines, const double* sines,
               double h, double omega, double delta, double* values, double* errors) {
    const double rounding = 16.0 * std::numeric_limits<double>::epsilon(), middle = 0.5 * omega * omega;
#pragma omp parallel
    {
        std::vector<double> scratch(7 * n);
        double* __restrict inertia = scratch.data();
        double* __restrict moment = inertia + n;
        double* __restrict work = moment + n;
        double* __restrict half_inertia = work + n;
        double* __restrict half_moment = half_inertia + n;
        double* __restrict travel = half_moment + n;
        double* __restrict input = travel + n;
#pragma omp for schedule(static)
        for (int v = 0; v < variants; ++v) {
            const Machine machine(parameters + static_cast<long>(v) * count);
            // Not cosines[0]: to use it again the compiler would read each position ahead, and vectorise nothing.
            const Reduced start = machine.at(1.0, 0.0);
            const double start_x = start.way.x, start_y = start.way.y;
#pragma omp simd
            for (int k = 0; k < n; ++k) {
                const Reduced r = machine.at(cosines[k], sines[k]);
                inertia[k] = r.inertia;
                moment[k] = r.moment;
                input[k] = middle * r.slope - r.moment;
                travel[k] = Machine::ROCKS ? start_x * r.way.y - start_y * r.way.x : r.way.x;
            }
            for (int k = 0; k < n / 2; ++k) {
                half_inertia[k] = inertia[2 * k];
                half_moment[k] = moment[2 * k];
            }
            const double first_kind = machine.crank_inertia;
            const Sizes half =
                flywheel_sizes(half_inertia, half_moment, work, n / 2, 2.0 * h, omega, delta, first_kind);
            const Sizes full = flywheel_sizes(inertia, moment, work, n, h, omega, delta, first_kind);
            const double jump = jump_work(moment, n, h), missed = missed_extreme(inertia, work, n, middle);
            const double energy = full.excess + omega * omega * mean_of(inertia, n);
            const double share = (jump + 2.0 * missed + rounding * energy) / (delta * omega * omega);
            const Extent way = extent(travel, n), turning = extent(input, n);
            double low = way.low, high = way.high, steep = 1.0;
            if (Machine::ROCKS) {
                const double far = std::max(-low, high);
                low = std::asin(low);
                high = std::asin(high);
                steep = 1.0 / std::sqrt((1.0 - far) * (1.0 + far));
            }
            const double peak = std::max(-turning.low, turning.high);
            const double at_full[SUMMARIES] = {full.drive, full.drive * omega, full.excess, full.by_excess,
                                               full.merzalov, full.wittenbauer, delta, high - low, peak};
            const double more[SUMMARIES] = {jump / (h * n) + std::abs(full.drive - half.drive),
                                            omega * (jump / (h * n) + std::abs(full.drive - half.drive)),
                                            jump + std::abs(full.excess - half.excess),
                                            share + std::abs(full.by_excess - half.by_excess),
                                            share + std::abs(full.merzalov - half.merzalov),
                                            share + std::abs(full.wittenbauer - half.wittenbauer),
                                            delta * share / (full.wittenbauer + inertia[0]),
                                            steep * (2.0 * way.missed + way.halved),
                                            turning.missed + turning.halved};
            for (int i = 0; i < SUMMARIES; ++i) {
                values[static_cast<long>(SUMMARIES) * v + i] = at_full[i];
                errors[static_cast<long>(SUMMARIES) * v + i] = more[i] + rounding * std::abs(at_full[i]);
            }
        }
    }
}

}  // namespace

extern "C" {

void use_threads(int count) { omp_set_num_threads(count); }

#define MACHINE(name, Machine)                                                                                    \
    void name##_fields(const double* p, int count, int variants, int n, const double* c, const double* s,         \
                       double* rows) {                                                                            \
        const long stride = static_cast<long>(variants) * n;                                                      \
        fields<Machine>(p, count, variants, n, c, s, rows, rows + stride, rows + 2 * stride);                     \
    }                                                                                                             \
    void name##_summaries(const double* p, int count, int variants, int n, const double* c, const double* s,      \
                          double h, double omega, double delta, double* values, double* errors) {                 \
        summaries<Machine>(p, count, variants, n, c, s, h, omega, delta, values, errors);                         \
    }

MACHINE(press, Press)
MACHINE(four_bar, FourBar)
MACHINE(six_bar, SixBar)

void six_bar_reactions(const double* p, int count, int variants, int n, const double* c, const double* s, double omega,
                       double* rows) {
    const long stride = static_cast<long>(variants) * n;
#pragma omp parallel for schedule(static)
    for (int v = 0; v < variants; ++v) {
        const SixBarForces machine(p + static_cast<long>(v) * count, omega);
        double* __restrict out = rows + static_cast<long>(v) * n;
#pragma omp simd
        for (int k = 0; k < n; ++k) machine.at(c[k], s[k], out + k, stride);
    }
}
}
