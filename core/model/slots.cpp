#include "core/model/slots.hpp"

namespace stickslip {

template Vector<double> bulk_forces(const Model&, const Slots<double>&, const Vector<double>&, const ElementLists*);
template Vector<double> load_vector(const Model&, const Load&, const Slots<double>&);
template Points<double> initial_points(const Model&, const Numbers<double>&);
template Slots<double> make_slots(const Model&, const Numbers<double>&, Points<double>);
template Slots<double> make_slots(const Model&, const Numbers<double>&);
template Vector<std::complex<double>> bulk_forces(const Model&, const Slots<std::complex<double>>&,
                                                  const Vector<std::complex<double>>&, const ElementLists*);
template Vector<std::complex<double>> load_vector(const Model&, const Load&, const Slots<std::complex<double>>&);
template Points<std::complex<double>> initial_points(const Model&, const Numbers<std::complex<double>>&);
template Slots<std::complex<double>> make_slots(const Model&, const Numbers<std::complex<double>>&,
                                                Points<std::complex<double>>);
template Slots<std::complex<double>> make_slots(const Model&, const Numbers<std::complex<double>>&);

}  // namespace stickslip
