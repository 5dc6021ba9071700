#include "studies/input/scene_reading.hpp"

#include <algorithm>
#include <limits>

#include "studies/input/file_objects.hpp"
#include "studies/io/atomic_file.hpp"
#include "studies/io/printing.hpp"

namespace stickslip {

std::vector<std::string> SceneReading::axes() const {
  return dimension() == 3 ? std::vector<std::string>{"x", "y", "z"} : std::vector<std::string>{"x", "y"};
}

int SceneReading::slot(const std::string& pointer, double value) {
  const auto [found, is_new] = slots.emplace(pointer, static_cast<int>(scene.numbers.size()));
  if (is_new) {
    scene.numbers.push_back(value);
    scene.pointers.push_back(pointer);
  }
  return found->second;
}

Number SceneReading::number(const JsonNode& node, const Rule& rule) {
  const double value = node.number(rule).value_or(std::numeric_limits<double>::quiet_NaN());
  return {value, slot(node.pointer(), value)};
}

Number SceneReading::required(const JsonNode& object, const std::string& key, const Rule& rule) {
  if (const auto node = object.find(key)) return number(*node, rule);
  return std::numeric_limits<double>::quiet_NaN();
}

Number SceneReading::optional(const JsonNode& object, const std::string& key, double standard, const Rule& rule) {
  if (const auto node = object.find(key)) return number(*node, rule);
  return {standard, slot(child_pointer(object.pointer(), key), standard)};
}

std::vector<Number> SceneReading::vector(const JsonNode& node, int size) {
  const auto elements = node.array(size, "an array of " + std::to_string(size) + " numbers");
  std::vector<Number> numbers(size, Number(std::numeric_limits<double>::quiet_NaN()));
  for (int i = 0; elements && i < size; ++i) numbers[i] = number((*elements)[i], any_number);
  return numbers;
}

std::vector<Number> SceneReading::required_vector(const JsonNode& object, const std::string& key, int size) {
  if (const auto node = object.find(key)) return vector(*node, size);
  return std::vector<Number>(size, Number(std::numeric_limits<double>::quiet_NaN()));
}

namespace {
constexpr const char* allowed_value =
    R"(a number, a table [[t, value], ...] with increasing t, or {"table": [...], "repeat": n})";
}

void SceneReading::points(const JsonNode& node, Table& table) {
  if (!node.value().is_array() || node.value().empty()) return node.must_be(allowed_value);
  for (const JsonNode& point : node.elements()) {
    const auto pair = point.array(2, "a pair [t, value]");
    if (!pair) continue;
    const auto t = time((*pair)[0], any_number);
    const Number value = number((*pair)[1], any_number);
    if (!t) continue;
    if (!table.points.empty() && !(*t > table.points.back().first))
      (*pair)[0].error("is " + shown((*pair)[0].value()) + "; times must increase, and the one before is " +
                       shown(table.points.back().first));
    table.points.emplace_back(*t, value);
  }
}

Table SceneReading::table(const JsonNode& node) {
  Table table;
  if (node.value().is_number()) {
    table.points = {{0, number(node, any_number)}};
  } else if (node.value().is_object()) {
    if (node.is_object(keys_of(scene_object("table"))))
      if (const auto of = node.find("table")) points(*of, table);
    if (const auto repeat = node.find("repeat")) table.repeat = count(*repeat, 1).value_or(1);
    if (table.repeat > 1 && table.points.size() < 2) {
      if (table.points.size() == 1) node.error("repeats a table of one point; must have two points at least");
    } else if (table.repeat > 1 && table.points.front().second.value != table.points.back().second.value) {
      node.error("repeats a table that jumps from " + shown(table.points.back().second.value) + " at its end to " +
                 shown(table.points.front().second.value) + " at its start; the two must be equal");
    }
    if (table.points.size() < 2) table.repeat = 1;
  } else {
    points(node, table);
  }
  if (table.points.empty()) table.points = {{0, Number()}};
  return table;
}

std::vector<Number> SceneReading::direction(const JsonNode& node, const char* what) {
  const auto numbers = vector(node, dimension());
  if (std::all_of(numbers.begin(), numbers.end(), [](const Number& n) { return n.value == 0; })) node.must_be(what);
  return numbers;
}

Rotation SceneReading::rotation(const JsonNode& node) {
  Rotation rotation;
  rotation.angle.points = {{0, Number()}};
  const bool space = dimension() == 3;
  if (!space && node.value().is_object())
    if (const auto axis = node.find("axis")) {
      axis->error_at_key("an axis needs the space solid; in a plane space a rotation is about its center");
      return rotation;
    }
  Keys keys = keys_of(scene_object("rotate"));
  if (space) keys.required = {"center", "axis", "angle"};
  if (!node.is_object({keys.required})) return rotation;
  rotation.center = required_vector(node, "center", dimension());
  if (const auto axis = node.find("axis")) rotation.axis = direction(*axis, "a vector that is not zero");
  if (const auto angle = node.find("angle")) rotation.angle = table(*angle);
  return rotation;
}

std::map<char, Table> SceneReading::move(const JsonNode& node) {
  std::map<char, Table> tables;
  if (!node.is_object({{}, axes()})) return tables;
  if (node.value().empty()) node.error("is empty; must name an axis: " + listed(axes()));
  for (const std::string& axis : axes())
    if (const auto value = node.find(axis)) tables.emplace(axis[0], table(*value));
  return tables;
}

std::optional<double> SceneReading::time(const JsonNode& node, const Rule& rule) {
  constants[node.pointer()] = "a time; times are no parameters, the values at them are";
  return node.number(rule);
}

std::optional<int> SceneReading::count(const JsonNode& node, int least) {
  constants[node.pointer()] = "a count, which has no derivative";
  return node.count(least);
}

std::optional<double> SceneReading::setting(const JsonNode& node, const Rule& rule) {
  constants[node.pointer()] = "a setting of the method, which the solution does not depend on";
  return node.number(rule);
}

std::optional<std::string> SceneReading::content_of(const JsonNode& node, const std::string& name,
                                                    const std::string& what, std::uintmax_t most) {
  const std::string path = path_of(name);
  const std::string fault = unreadable(path, most);
  if (fault.empty()) return read_file(path);
  node.error("the " + what + " file " + path + " " + fault);
  return std::nullopt;
}

std::string SceneReading::sides_called(const std::string& name) const {
  std::vector<std::string> whole;
  for (const std::string& body : body_names)
    if (const auto mesh = meshes.find(body); mesh != meshes.end()) {
      const SideExpression side = parse_side_expression(body + "." + name);
      if (side.error.empty() && side_error(mesh->second, side).empty()) whole.push_back(in_quotes(body + "." + name));
    }
  return whole.empty() ? "" : "; did you mean " + listed(whole) + "?";
}

std::optional<NamedSide> SceneReading::side(const JsonNode& node) {
  const auto text = node.text();
  if (!text) return std::nullopt;
  const SideExpression expression = parse_side_expression(*text);
  auto fault = [&](const std::string& message) {
    node.error("is " + in_quotes(*text) + ": " + message);
    return std::nullopt;
  };
  if (!expression.error.empty()) {
    const bool body = std::find(body_names.begin(), body_names.end(), *text) != body_names.end();
    return fault(body ? "a body; must be BODY.SIDE" : expression.error + sides_called(*text));
  }
  if (std::find(body_names.begin(), body_names.end(), expression.body) == body_names.end())
    return fault("there is no body " + in_quotes(expression.body) + ";" + suggestion(expression.body, body_names) +
                 " allowed: " + listed(body_names));
  const auto mesh = meshes.find(expression.body);
  if (mesh == meshes.end()) return std::nullopt;
  if (const std::string error = side_error(mesh->second, expression); !error.empty()) return fault(error);
  return NamedSide{expression.body, &mesh->second, evaluate_side(mesh->second, expression)};
}

void check_name(const JsonNode& node, const std::string& name) {
  if (name.empty() || name.find_first_of(".& \t\n") != std::string::npos)
    node.error_at_key("the name " + in_quotes(name) + " must have letters, and no space, dot or &");
  else
    check_characters(node, name);
}

void check_characters(const JsonNode& node, const std::string& name) {
  if (printable(name) != name) node.error_at_key("the name " + in_quotes(name) + " must have no control characters");
}

}  // namespace stickslip
