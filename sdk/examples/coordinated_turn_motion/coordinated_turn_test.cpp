// The model against its own laws: two steps are one, the Jacobian is the derivative, the series meet the closed forms, a
// quarter turn ends where geometry says.
#include <cstdio>

#include "coordinated_turn.cpp"

namespace {

int failures = 0;

void check(const char* law, double error, double limit) {
    const bool good = error <= limit;  // false for what is not a number
    std::printf("%-60s %9.2e  %s\n", law, error, good ? "ok" : "FAILED");
    failures += good ? 0 : 1;
}

pelorus::Step step(double dt) {
    pelorus::Step out;
    out.dt = dt;
    return out;
}

}  // namespace

int main() {
    const CoordinatedTurn motion;
    for (const double rate : {0.0, 1e-9, 0.01, 0.0625, 0.4, -2.0}) {
        CoordinatedTurn::State from;
        from << 1000, -2000, 300, 90, -40, 5, rate;
        check("two steps are one",
              (motion.propagate(motion.propagate(from, step(1.5)), step(2.5)) - motion.propagate(from, step(4))).norm(),
              1e-11 * 3000);
        check("no time, no motion", (motion.propagate(from, step(0)) - from).norm(), 0);
        CoordinatedTurn::Transition differences;
        for (int i = 0; i < states; ++i) {
            const double h = i == w ? 1e-5 : 1e-2;
            CoordinatedTurn::State up = from, down = from;
            up(i) += h;
            down(i) -= h;
            differences.col(i) = (motion.propagate(up, step(4)) - motion.propagate(down, step(4))) / (up(i) - down(i));
        }
        check("the Jacobian is the derivative", (motion.jacobian(from, step(4)) - differences).norm(), 1e-5);
    }

    const Turn below(0.25 * (1 - 1e-15)), above(0.25);
    check("series and closed forms meet",
          std::fabs(below.along - above.along) + std::fabs(below.across - above.across) +
              std::fabs(below.d_along - above.d_along) + std::fabs(below.d_across - above.d_across),
          2e-14);

    // 100 m/s, a quarter turn to the left within 10 s: a circle of radius v/w, centre to the left of the start.
    const double quarter = std::acos(0.0), radius = 100 / (quarter / 10);
    CoordinatedTurn::State from = CoordinatedTurn::State::Zero(), to = from;
    from(vx) = 100;
    from(w) = quarter / 10;
    to << radius, radius, 0, 0, 100, 0, quarter / 10;
    check("a quarter turn", (motion.propagate(from, step(10)) - to).norm(), 1e-10);
    return failures == 0 ? 0 : 1;
}
