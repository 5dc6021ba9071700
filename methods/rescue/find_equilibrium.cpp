#include "methods/rescue/find_equilibrium.hpp"

namespace stickslip {

template Equilibrium<double> find_equilibrium(Engine<double>&, const EquilibriumTask<double>&, Unknowns<double>,
                                              const NewtonOptions&, Account&);

}  // namespace stickslip
