#include "core/mesh/sides.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <stdexcept>

namespace stickslip {
namespace {

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

bool is_space(const std::string& text, std::size_t i) { return text[i] == ' ' || text[i] == '\t'; }

std::optional<SideOperation> operation_at(const std::string& text, std::size_t i) {
  if (text[i] == '&') return SideOperation::intersect;
  const bool apart = i > 0 && i + 1 < text.size() && is_space(text, i - 1) && is_space(text, i + 1);
  if (text[i] == '-' && apart) return SideOperation::leave_out;
  return std::nullopt;
}

/// Names and operations in order; the first name's operation means nothing.
std::vector<std::pair<SideOperation, std::string>> split(const std::string& text) {
  std::vector<std::pair<SideOperation, std::string>> terms(1);
  for (std::size_t i = 0; i < text.size(); ++i)
    if (const auto operation = operation_at(text, i))
      terms.push_back({*operation, ""});
    else
      terms.back().second += text[i];
  for (auto& term : terms) term.second = trimmed(term.second);
  return terms;
}

std::string quoted(const std::string& text) { return "\"" + text + "\""; }

constexpr const char* whole_boundary = "boundary";

bool has_side(const Mesh& mesh, const std::string& name) {
  return mesh.sides.count(name) > 0 || (name == whole_boundary && is_continuum(mesh.shape));
}

Side side_named(const Mesh& mesh, const std::string& name) {
  const auto found = mesh.sides.find(name);
  return found == mesh.sides.end() ? boundary_of(mesh) : found->second;
}

std::string unknown_side(const Mesh& mesh, const std::string& name) {
  if (has_side(mesh, name)) return "";
  std::vector<std::string> names;
  std::string list;
  for (const auto& [side, unused] : mesh.sides) {
    names.push_back(side);
    list += (list.empty() ? "" : ", ") + side;
  }
  if (names.empty()) return "there is no side " + quoted(name) + ": the mesh has none";
  return "there is no side " + quoted(name) + "; did you mean " + quoted(nearest_name(name, names)) +
         "? the mesh has " + list;
}

/// pre: all names exist.
Side apply(const Mesh& mesh, const SideExpression& expression) {
  Side result = side_named(mesh, expression.side);
  for (const auto& [operation, name] : expression.operations) {
    const Side other = side_named(mesh, name);
    const std::set<int> others(other.nodes.begin(), other.nodes.end());
    const bool keep = operation == SideOperation::intersect;
    std::erase_if(result.nodes, [&](int node) { return (others.count(node) == 1) != keep; });
    const std::set<int> left(result.nodes.begin(), result.nodes.end());
    auto restrict_to = [&](std::vector<std::vector<int>>& facets, const std::vector<std::vector<int>>& of_other) {
      const std::set<std::vector<int>> shared(of_other.begin(), of_other.end());
      std::erase_if(facets, [&](const std::vector<int>& facet) {
        if (keep) return shared.count(facet) == 0;
        return std::none_of(facet.begin(), facet.end(), [&](int node) { return left.count(node) == 1; });
      });
    };
    restrict_to(result.facets, other.facets);
    restrict_to(result.quadratic, other.quadratic);
  }
  return result;
}

}  // namespace

std::vector<ElementSide> free_sides(const Mesh& mesh) {
  const int count = nodes_of(mesh.shape);
  std::map<std::vector<int>, int> elements_at;  // by the nodes of a side, ascending
  const auto key_of = [](std::vector<int> nodes) {
    std::sort(nodes.begin(), nodes.end());
    return nodes;
  };
  std::vector<ElementSide> sides;
  for (int e = 0; e < mesh.element_count(); ++e)
    for (const auto& side : sides_of(mesh.shape)) {
      sides.push_back({e, {}});
      for (const int a : side) sides.back().nodes.push_back(mesh.connectivity[static_cast<std::size_t>(e) * count + a]);
      ++elements_at[key_of(sides.back().nodes)];
    }
  std::erase_if(sides, [&](const ElementSide& side) { return elements_at.at(key_of(side.nodes)) > 1; });
  return sides;
}

Side boundary_of(const Mesh& mesh) {
  const auto sides = free_sides(mesh);
  if (is_solid(mesh.shape)) {
    Side side;
    std::set<int> ascending;
    for (const auto& [element, nodes] : sides) {
      for (auto& facet : facets_of_side(nodes, 3)) side.facets.push_back(std::move(facet));
      if (is_quadratic(mesh.shape)) side.quadratic.push_back(nodes);
      ascending.insert(nodes.begin(), nodes.end());
    }
    side.nodes.assign(ascending.begin(), ascending.end());
    return side;
  }
  std::map<std::pair<int, int>, std::vector<int>> edges;  // start and end -> start, end (, middle)
  for (const auto& [element, nodes] : sides) edges.emplace(std::pair{nodes[0], nodes[1]}, nodes);
  Side side;
  std::map<int, std::vector<int>> by_start;
  for (const auto& [ends, edge] : edges) by_start.emplace(ends.first, edge);
  while (!by_start.empty()) {  // one loop after another
    for (auto next = by_start.begin(); next != by_start.end();) {
      const std::vector<int> edge = next->second;
      by_start.erase(next);
      side.nodes.push_back(edge[0]);
      if (edge.size() == 3) {
        side.nodes.push_back(edge[2]);
        side.facets.push_back({edge[0], edge[2]});
        side.facets.push_back({edge[2], edge[1]});
        side.quadratic.push_back(edge);
      } else {
        side.facets.push_back(edge);
      }
      next = by_start.find(edge[1]);
    }
  }
  return side;
}

SideExpression parse_side_expression(const std::string& text) {
  SideExpression expression;
  bool first = true;
  for (const auto& [operation, term] : split(text)) {
    const auto dot = term.find('.');
    const std::string body = trimmed(term.substr(0, dot));
    const std::string side = dot == std::string::npos ? "" : trimmed(term.substr(dot + 1));
    if (term.empty()) {
      expression.error = "a side BODY.SIDE is missing in " + quoted(text);
    } else if (body.empty() || side.empty()) {
      expression.error = quoted(term) + " is not BODY.SIDE";
    } else if (side.find('-') != std::string::npos && side.find('.') != std::string::npos) {
      expression.error = "write a space on both sides of the - in " + quoted(term);
    } else if (!first && body != expression.body) {
      expression.error = "the sides of " + quoted(text) + " belong to two bodies, " + expression.body + " and " + body;
    }
    if (!expression.error.empty()) return expression;
    if (first) {
      expression.body = body;
      expression.side = side;
    } else {
      expression.operations.push_back({operation, side});
    }
    first = false;
  }
  return expression;
}

std::string side_error(const Mesh& mesh, const SideExpression& expression) {
  if (!expression.error.empty()) return expression.error;
  if (std::string error = unknown_side(mesh, expression.side); !error.empty()) return error;
  for (const auto& [operation, name] : expression.operations)
    if (std::string error = unknown_side(mesh, name); !error.empty()) return error;
  if (apply(mesh, expression).nodes.empty()) return "no node belongs to this set of sides";
  return "";
}

Side evaluate_side(const Mesh& mesh, const SideExpression& expression) {
  if (const std::string error = side_error(mesh, expression); !error.empty()) throw std::invalid_argument(error);
  return apply(mesh, expression);
}

Side evaluate_side(const Mesh& mesh, const std::string& expression) {
  const auto terms = split(expression);
  SideExpression without_body{"", terms.front().second, {}, ""};
  without_body.operations.assign(terms.begin() + 1, terms.end());
  return evaluate_side(mesh, without_body);
}

std::string nearest_name(const std::string& name, const std::vector<std::string>& candidates) {
  std::string nearest;
  std::size_t least = 0;
  for (const std::string& candidate : candidates) {
    // row of Levenshtein's table: distance of the part of `name` read so far to each beginning of the candidate
    std::vector<std::size_t> row(candidate.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < name.size(); ++i) {
      std::size_t diagonal = row[0]++;
      for (std::size_t j = 0; j < candidate.size(); ++j) {
        const std::size_t replaced = diagonal + (name[i] == candidate[j] ? 0 : 1);
        diagonal = row[j + 1];
        row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
      }
    }
    if (nearest.empty() || row.back() < least) {
      nearest = candidate;
      least = row.back();
    }
  }
  return nearest;
}

}  // namespace stickslip
