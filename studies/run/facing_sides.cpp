#include "studies/run/facing_sides.hpp"

#include <limits>

#include "core/contact/surfaces.hpp"
#include "core/model/pairing.hpp"

namespace stickslip {
namespace {

struct MiddleOfFacet {
  Vector<double> place, normal;  ///< outward, of length 1
};

std::vector<MiddleOfFacet> middles(const Problem& problem, const std::string& name) {
  const auto& points = problem.slots.points;
  std::vector<MiddleOfFacet> all;
  for (const auto& facet : surface_of(problem.model, points, problem.model.side(name)).facets) {
    Vector<double> sum = Vector<double>::Zero(points.rows());
    for (int node : facet) sum += points.col(node);
    all.push_back({sum / static_cast<double>(facet.size()), outward_normal(points, facet).normalized()});
  }
  return all;
}

/// Least distance, length, of two middles that look at each other; infinite: none do.
double distance(const std::vector<MiddleOfFacet>& one, const std::vector<MiddleOfFacet>& other) {
  constexpr double opposed = -0.5, ahead = -0.1;  // cosines; sides that touch may overlap a little
  double least = std::numeric_limits<double>::infinity();
  for (const auto& a : one)
    for (const auto& b : other) {
      const Vector<double> way = b.place - a.place;
      const double length = way.norm();
      if (length < least && a.normal.dot(b.normal) < opposed && a.normal.dot(way) >= ahead * length) least = length;
    }
  return least;
}
}  // namespace

Vector<double> outward_normal(const Points<double>& points, const std::vector<int>& facet) {
  return with_dimension(static_cast<int>(points.rows()),
                        [&]<int D>() { return Vector<double>(slave_normal<D>({facet}, points)); });
}

std::map<int, Vector<double>> outward_normals(const Points<double>& points, const SideSet& side) {
  std::map<int, Vector<double>> normals;
  for (const auto& facet : side.facets) {
    const Vector<double> normal = outward_normal(points, facet);
    for (int node : facet) normals.try_emplace(node, Vector<double>::Zero(points.rows())).first->second += normal;
  }
  return normals;
}

std::vector<std::string> names_of_sides(const Model& model, int body) {
  std::multimap<std::size_t, std::string> by_size;
  for (const auto& [name, side] : model.bodies[body].mesh.sides)
    if (!side.facets.empty()) by_size.emplace(side.facets.size(), model.scene.bodies[body].name + "." + name);
  std::vector<std::string> names;
  for (auto& [size, name] : by_size) names.push_back(std::move(name));
  return names;
}

std::optional<std::pair<std::string, std::string>> facing_sides(const Problem& problem, int contact) {
  const Model& model = problem.model;
  const auto& sides = model.contact_sides[contact];
  const int slave = sides.slave.body, master = sides.master.body;
  if (sides.obstacle >= 0 || slave == master) return std::nullopt;
  if (!is_continuum(model.bodies[slave].mesh.shape) || !is_continuum(model.bodies[master].mesh.shape))
    return std::nullopt;
  std::vector<std::vector<MiddleOfFacet>> of_master;
  const auto masters = names_of_sides(model, master);
  for (const auto& name : masters) of_master.push_back(middles(problem, name));
  std::optional<std::pair<std::string, std::string>> nearest;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& name : names_of_sides(model, slave)) {
    const auto of_slave = middles(problem, name);
    for (std::size_t m = 0; m < masters.size(); ++m)
      if (const double now = distance(of_slave, of_master[m]); now < least) {
        least = now;
        nearest = {name, masters[m]};
      }
  }
  return nearest;
}

}  // namespace stickslip
