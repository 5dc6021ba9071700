/// Definition of point_tangent(), by dual numbers through the kernel of the residual.
#pragma once

#include "core/model/contact_assembly_impl.hpp"
#include "core/model/point_tangent.hpp"
#include "core/model/stencil.hpp"

namespace stickslip {

namespace detail {

/// The same geometry in the scalar U built on T, without weights.
template <class U, class T>
PointGeometry<U> promote(const PointGeometry<T>& g) {
  PointGeometry<U> out;
  auto cast = [](const T& x) { return U(x); };
  out.gap = U(g.gap);
  out.area = U(g.area);
  out.normal = g.normal.unaryExpr(cast);
  out.tangents = g.tangents.unaryExpr(cast);
  return out;
}

/// The multiplier of a point, seeded by lambda / rho from direction `first` on.
template <class Probe, class T, int Tangents>
Traction<Probe, Tangents> seeded_multiplier(const ContactInput<T>& input, int p, const Vector<T>& multiplier,
                                            int first) {
  const auto lambda = gather_traction<T, Tangents>(multiplier, input.model.points[p].multiplier);
  Traction<Probe, Tangents> seeded;
  seeded.normal = Probe(lambda.normal);
  seeded.normal.d[first] = input.rho[p].normal;
  for (int a = 0; a < Tangents; ++a) {
    seeded.tangential[a] = Probe(lambda.tangential[a]);
    seeded.tangential[a].d[first + 1 + a] = input.rho[p].tangential;
  }
  return seeded;
}

/// Constant input of a point, in the dual scalar.
template <class Probe, class T, int Tangents>
struct FixedInput {
  FixedInput(const ContactInput<T>& input, int p)
      : rho{Probe(input.rho[p].normal), Probe(input.rho[p].tangential)},
        friction(input.slots.friction[input.model.points[p].contact].template as<Probe>(
            [](const T& number) { return Probe(number); })) {
    const auto previous = previous_placement<T, Tangents>(input, p);
    for (int a = 0; a < Tangents; ++a) placement[a] = Probe(previous[a]);
  }
  PointRegularisation<Probe> rho;
  FrictionLaw<Probe> friction;
  Vec<Probe, Tangents> placement;
};

/// Row r of t - lambda.
template <class Probe, int Tangents>
Probe row_of(const Traction<Probe, Tangents>& traction, const Traction<Probe, Tangents>& lambda, int r) {
  return r == 0 ? traction.normal - lambda.normal : traction.tangential[r - 1] - lambda.tangential[r - 1];
}

/// Evaluates a point once, at displacements with derivatives, and takes the tangent's columns that these are of.
///
///   displacement  place -> displacement in the scalar Probe
///   of_lambda     the first of the directions that the multiplier is seeded in
///   faced         nodes that have forces
///   spread        (x, row): writes the derivatives of x by the displacements into a row
template <class T, int D, int Tangents, class Probe, class Displacement, class Spread>
void sweep(const ContactInput<T>& input, int p, const Facing& facing, const FixedInput<Probe, T, Tangents>& fixed,
           const Displacement& displacement, const Vector<T>& multiplier, int of_lambda, ContactState state, int faced,
           Spread&& spread, PointTangent<T>& tangent) {
  constexpr int C = 1 + Tangents;
  const Positions<Probe, T, Displacement> positions{input.model, input.slots, displacement, input.time};
  const auto at = place_point<D>(positions, input.model.points[p], facing, earlier(input, p));
  const auto lambda = seeded_multiplier<Probe, T, Tangents>(input, p, multiplier, of_lambda);
  const auto outcome =
      point_outcome<Probe, T, D, Tangents>(input, at, lambda, fixed.placement, fixed.rho, fixed.friction, 0, &state);
  const Vec<Probe, D> force = point_force<Probe, D, Tangents>(at.geometry, outcome.traction);
  tangent.has_potential = at.has_potential;
  for (int n = 0; n < std::min(faced, static_cast<int>(at.geometry.weights.size())); ++n)
    for (int i = 0; i < D; ++i) {
      const Probe share = at.geometry.weights[n] * force[i];
      spread(share, tangent.force_w.row(D * n + i));
      for (int c = 0; c < C; ++c) tangent.force_l(D * n + i, c) = share.d[of_lambda + c];
    }
  const T& area = input.slots.geometry[p].area;
  for (int r = 0; r < C; ++r) {
    const Probe row = area * row_of(outcome.traction, lambda, r);
    spread(row, tangent.row_w.row(r));
    for (int c = 0; c < C; ++c) tangent.row_l(r, c) = row.d[of_lambda + c];
  }
}

/// Indices in Model::contact_nodes of the columns of a tangent: of the nodes that the point touches, and on a surface
/// of those that its last foot is on. The first `faced` of them also have forces.
template <class T>
std::vector<int> places_of_tangent(const ContactInput<T>& input, int p, const Facing& facing, int& faced) {
  const auto& point = input.model.points[p];
  std::vector<int> places;
  places.reserve(9);  // of the slave node and two patches
  for_each_place(input.model, point, facing, [&](int place) { places.push_back(place); });
  faced = static_cast<int>(places.size());
  if (point.is_integrated() || point.foot < 0) return places;
  if (facing.patch != no_patch || input.previous.faced[p])
    for_each_place(input.model.surfaces[point.surface], input.previous.patch[p], [&](int place) {
      if (std::find(places.begin(), places.end(), place) == places.end()) places.push_back(place);
    });
  return places;
}

/// Whether the tangent of a point is by the displacements of all nodes that it touches.
inline bool has_places(const Model& model, const ContactPoint& point) {
  return (point.surface >= 0 || point.is_integrated()) && model.effects.current_geometry;
}

/// Tangent of an open point: it bears nothing wherever it is, and its rows are -A lambda.
template <class T>
PointTangent<T> open_tangent(const ContactInput<T>& input, int p, const Facing& facing) {
  const auto& point = input.model.points[p];
  PointTangent<T> tangent;
  int faced = 0, count = input.model.dimension;
  if (has_places(input.model, point)) {
    tangent.places = places_of_tangent(input, p, facing, faced);
    count *= static_cast<int>(tangent.places.size());
  }
  const int components = point.components();
  tangent.force_w = Matrix<T>::Constant(count, count, T(0));
  tangent.force_l = Matrix<T>::Constant(count, components, T(0));
  tangent.row_w = Matrix<T>::Constant(components, count, T(0));
  tangent.row_l = Matrix<T>::Constant(components, components, T(0));
  for (int c = 0; c < components; ++c)
    tangent.row_l(c, c) = input.slots.geometry[p].area * -(c == 0 ? input.rho[p].normal : input.rho[p].tangential);
  return tangent;
}

/// What a point in space takes from the displacements of its nodes, to first order: its own motion; that of the place
/// that it faces, and of the surface's slopes there; and likewise at its last foot. That are seven sums over the nodes,
/// however many these are. Rows: an orthonormal basis of the weights of these sums, at most seven; columns: `places`.
/// pre: it faces a place.
template <class T>
Eigen::MatrixXd jets_of(const ContactInput<T>& input, int p, const Facing& facing, const std::vector<int>& places) {
  constexpr double rounding = 1e-13;  // of a row: what is left of one that the others span
  constexpr int most = 7;
  const auto& point = input.model.points[p];
  const MasterSurface& surface = input.model.surfaces[point.surface];
  Eigen::MatrixXd basis(most, static_cast<Eigen::Index>(places.size()));
  Eigen::Index count = 0;
  const auto add = [&](Eigen::RowVectorXd row) {
    const double size = row.norm();
    for (int twice = 0; twice < 2; ++twice) row -= row * basis.topRows(count).transpose() * basis.topRows(count);
    if (row.norm() > rounding * size) basis.row(count++) = row.normalized();
  };
  add(Eigen::RowVectorXd::Unit(basis.cols(), 0));
  const auto add_place = [&](int patch, const Vec<double, 2>& at) {
    const CurvedWeights weights = curved_weights(surface.patches<3>()[patch], at);
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(3, basis.cols());
    Eigen::Index vertex = 0;
    for_each_place(surface, patch, [&](int place) {
      const auto column = std::find(places.begin(), places.end(), place) - places.begin();
      sums.col(column) += weights.row(vertex++).head<3>().transpose();
    });
    for (const auto& row : sums.rowwise()) add(row);
  };
  add_place(facing.patch, facing.at);
  if (const auto last = earlier(input, p); point.foot >= 0 && last.patch != no_patch)
    add_place(last.patch, stored_place<3>(input.model, point, last.patch, last.foot).at);
  return basis.topRows(count);
}

/// Displacements of the nodes at `places` with derivatives, first those along jets_of() the nodes.
template <class T, class Probe>
struct AlongJets {
  const Vector<T>& compact;
  const std::vector<int>& places;
  const Eigen::MatrixXd& jets;
  Vec<Probe, 3> operator()(int place) const {
    const auto column = std::find(places.begin(), places.end(), place) - places.begin();
    Vec<Probe, 3> u;
    for (int i = 0; i < 3; ++i) {
      u[i] = Probe(compact[3 * place + i]);
      for (Eigen::Index r = 0; r < jets.rows(); ++r) u[i].d[3 * r + i] = T(jets(r, column));
    }
    return u;
  }
};

/// Tangent of a point in space by the displacements of the nodes at the places `of`, of which the first `faced` have
/// forces: by dual numbers along jets_of() them.
template <class T, int Tangents>
PointTangent<T> tangent_by_jets(const ContactInput<T>& input, int p, const Facing& facing, std::vector<int> of,
                                int faced, const Vector<T>& compact, const Vector<T>& multiplier, ContactState state) {
  constexpr int D = 3, C = 1 + Tangents, seeds = 7 * D;
  using Probe = Dual<seeds + D, T>;  // (D, not C: what moves is compiled once, with friction or without)
  PointTangent<T> tangent;
  auto& places = tangent.places;
  places = std::move(of);
  const Eigen::MatrixXd jets = jets_of(input, p, facing, places);
  const AlongJets<T, Probe> displacement{compact, places, jets};
  const auto spread = [&](const Probe& x, auto&& row) {
    for (Eigen::Index k = 0; k < jets.cols(); ++k)
      for (int i = 0; i < D; ++i) {
        T sum(0);
        for (Eigen::Index r = 0; r < jets.rows(); ++r) sum += x.d[D * r + i] * T(jets(r, k));
        row[D * k + i] = sum;
      }
  };
  const auto count = static_cast<Eigen::Index>(D * places.size());
  tangent.force_w = Matrix<T>::Constant(count, count, T(0));
  tangent.force_l = Matrix<T>::Constant(count, C, T(0));
  tangent.row_w.resize(C, count);
  tangent.row_l.resize(C, C);
  sweep<T, D, Tangents, Probe>(input, p, facing, {input, p}, displacement, multiplier, seeds, state, faced, spread,
                               tangent);
  return tangent;
}

/// Displacements of the nodes at `places`, with the derivatives by their dofs from `first` on, `count` of them.
template <class T, class Probe>
struct SeededDofs {
  const Vector<T>& compact;
  const std::vector<int>& places;
  int first, count;
  Vec<Probe, 2> operator()(int place) const {
    const int k = 2 * static_cast<int>(std::find(places.begin(), places.end(), place) - places.begin()) - first;
    Vec<Probe, 2> u;
    for (int i = 0; i < 2; ++i) {
      u[i] = Probe(compact[2 * place + i]);
      if (k >= 0 && k < count) u[i].d[k + i] = T(1);
    }
    return u;
  }
};

/// Tangent of a point of the plane by the displacements of the nodes at the places `of`, of which the first `faced`
/// have forces, `at_once` dofs in one sweep. `facing`: what the point faces of its surface.
template <class T, int Tangents, int at_once>
PointTangent<T> tangent_by_places(const ContactInput<T>& input, int p, const Facing& facing, std::vector<int> of,
                                  int faced, const Vector<T>& compact, const Vector<T>& multiplier,
                                  ContactState state) {
  constexpr int D = 2, C = 1 + Tangents;
  using Probe = Dual<at_once + D, T>;  // (as in tangent_by_jets)
  PointTangent<T> tangent;
  auto& places = tangent.places;
  places = std::move(of);
  const int count = static_cast<int>(D * places.size());
  tangent.force_w = Matrix<T>::Constant(count, count, T(0));
  tangent.force_l = Matrix<T>::Constant(count, C, T(0));
  tangent.row_w.resize(C, count);
  tangent.row_l.resize(C, C);
  const FixedInput<Probe, T, Tangents> fixed(input, p);
  for (int first = 0; first < count; first += at_once) {
    const int seeded = std::min(at_once, count - first);
    const SeededDofs<T, Probe> displacement{compact, places, first, seeded};
    const auto spread = [&](const Probe& x, auto&& row) {
      for (int j = 0; j < seeded; ++j) row[first + j] = x.d[j];
    };
    sweep<T, D, Tangents, Probe>(input, p, facing, fixed, displacement, multiplier, seeded, state, faced, spread,
                                 tangent);
  }
  return tangent;
}

/// Tangent of a point that moves as its slave node does against an obstacle, or at small strain by w: by one motion.
template <class T, int D, int Tangents>
PointTangent<T> tangent_of_motion(const ContactInput<T>& input, int p, const Vector<T>& compact,
                                  const Vector<T>& multiplier, ContactState state) {
  const auto& point = input.model.points[p];
  constexpr int C = 1 + Tangents;
  using Probe = Dual<2 * D, T>;
  const bool present = input.model.effects.current_geometry;
  Vec<T, D> w_value;
  if (present)
    w_value = compact.template segment<D>(point.places[0] * D);
  else
    w_value = relative_displacement<T, D>(input, p, compact);
  Vec<Probe, D> w;
  for (int i = 0; i < D; ++i) w[i] = Probe::seed(w_value[i], i);
  const auto lambda = seeded_multiplier<Probe, T, Tangents>(input, p, multiplier, D);
  const FixedInput<Probe, T, Tangents> fixed_input(input, p);
  PointOutcome<Probe, Tangents> outcome;
  PointGeometry<Probe> geometry;
  if (present) {
    const auto displacement = [&](int) { return w; };
    const Positions<Probe, T, decltype(displacement)> positions{input.model, input.slots, displacement, input.time};
    auto at = on_obstacle<D>(positions, point, earlier(input, p));
    outcome = point_outcome<Probe, T, D, Tangents>(input, at, lambda, fixed_input.placement, fixed_input.rho,
                                                   fixed_input.friction, 0, &state);
    geometry = std::move(at.geometry);
  } else {
    geometry = promote<Probe>(input.slots.geometry[p]);
    outcome = evaluate_point<Probe, D, Tangents>(geometry, w, lambda, fixed_input.placement, fixed_input.rho,
                                                 fixed_input.friction, input.cone, 0, &state);
  }
  const Vec<Probe, D> force = point_force<Probe, D, Tangents>(geometry, outcome.traction);
  PointTangent<T> tangent{Matrix<T>(D, D), Matrix<T>(D, C), Matrix<T>(C, D), Matrix<T>(C, C)};
  for (int i = 0; i < D; ++i) {
    for (int j = 0; j < D; ++j) tangent.force_w(i, j) = force[i].d[j];
    for (int c = 0; c < C; ++c) tangent.force_l(i, c) = force[i].d[D + c];
  }
  for (int r = 0; r < C; ++r) {
    const Probe row = input.slots.geometry[p].area * row_of(outcome.traction, lambda, r);
    for (int j = 0; j < D; ++j) tangent.row_w(r, j) = row.d[j];
    for (int c = 0; c < C; ++c) tangent.row_l(r, c) = row.d[D + c];
  }
  return tangent;
}

}  // namespace detail

template <class T>
PointTangent<T> point_tangent(const ContactInput<T>& input, int p, const Vector<T>& compact,
                              const Vector<T>& multiplier, ContactState state, const std::vector<Facing>& facing) {
  const auto& point = input.model.points[p];
  const bool by_places = detail::has_places(input.model, point);
  const Facing& found = by_places && point.surface >= 0 ? facing[p] : point.facing;
  const bool faces_nothing = by_places && point.surface >= 0 && found.patch == no_patch;
  if (state == ContactState::open || faces_nothing) return detail::open_tangent(input, p, found);
  return detail::with_point(input.model, point, [&]<int D, int Tangents>() {
    if (by_places) {
      int faced = 0;
      auto places = detail::places_of_tangent(input, p, found, faced);
      if constexpr (D == 2) {
        const auto tangent = [&]<int at_once>() {
          return detail::tangent_by_places<T, Tangents, at_once>(input, p, found, std::move(places), faced, compact,
                                                                 multiplier, state);
        };
        // 18: the slave node and four vertices each of this patch and of the last; 12: where these are neighbours.
        return places.size() <= 6 ? tangent.template operator()<12>() : tangent.template operator()<18>();
      } else {
        return detail::tangent_by_jets<T, Tangents>(input, p, found, std::move(places), faced, compact, multiplier,
                                                    state);
      }
    }
    return detail::tangent_of_motion<T, D, Tangents>(input, p, compact, multiplier, state);
  });
}

}  // namespace stickslip
