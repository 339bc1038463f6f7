// The same as a module of pybind11: it takes and returns arrays as an update routine does.

#include <cmath>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

namespace py = pybind11;
using Given = py::array_t<double, py::array::c_style | py::array::forcecast>;

static py::array_t<double> friction(Given trial, Given pressure, Given /* stiffness */, double mu)
{
    auto t = trial.unchecked<2>();
    auto p = pressure.unchecked<1>();
    py::array_t<double> stress({t.shape(0), t.shape(1)});
    auto s = stress.mutable_unchecked<2>();
    for (py::ssize_t i = 0; i < t.shape(0); i++) {
        const double size = std::hypot(t(i, 0), t(i, 1)), limit = mu * std::abs(p(i)), share = size > limit ? limit / size : 1.0;
        s(i, 0) = share * t(i, 0);
        s(i, 1) = share * t(i, 1);
    }
    return stress;
}

PYBIND11_MODULE(friction_pybind, module) { module.def("friction", &friction, py::arg("trial"), py::arg("pressure"), py::arg("stiffness"), py::arg("mu")); }
