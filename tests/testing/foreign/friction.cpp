// A routine in C++ behind a C function: one call answers n increments.

#include <algorithm>
#include <cmath>

namespace {
struct Disk {
    double mu;
    double share(double a, double b, double pressure) const { return std::min(1.0, mu * std::abs(pressure) / std::max(std::hypot(a, b), 1e-300)); }
};
}  // namespace

extern "C" void friction(int n, const double *trial, const double *pressure, double mu, double *stress)
{
    const Disk disk{mu};
    for (int i = 0; i < n; i++)
        for (int j = 0; j < 2; j++) stress[2 * i + j] = trial[2 * i + j] * disk.share(trial[2 * i], trial[2 * i + 1], pressure[i]);
}
