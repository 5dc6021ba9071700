#include "studies/io/vtu.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <string_view>

#include "studies/io/printing.hpp"

namespace stickslip {
namespace {

constexpr std::string_view byte_order = std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";

int points_of(VtuCell cell) {
  switch (cell) {
    case VtuCell::vertex:
      return 1;
    case VtuCell::line:
      return 2;
    case VtuCell::triangle:
      return 3;
    case VtuCell::quad:
      return 4;
    case VtuCell::triangle6:
      return 6;
    case VtuCell::quad8:
      return 8;
    case VtuCell::tetra:
      return 4;
    case VtuCell::hexahedron:
      return 8;
    case VtuCell::tetra10:
      return 10;
    case VtuCell::hexahedron20:
      return 20;
    case VtuCell::hexahedron27:
      return 27;
  }
  throw std::invalid_argument("vtu: unknown kind of cell");
}

VtuCell cell_of(ElementShape shape) {
  switch (shape) {
    case ElementShape::point:  // a node and the anchor of its spring
      return VtuCell::line;
    case ElementShape::bar2:
      return VtuCell::line;
    case ElementShape::tri3:
      return VtuCell::triangle;
    case ElementShape::quad4:
      return VtuCell::quad;
    case ElementShape::tri6:
      return VtuCell::triangle6;
    case ElementShape::quad8:
      return VtuCell::quad8;
    case ElementShape::tet4:
      return VtuCell::tetra;
    case ElementShape::hex8:
      return VtuCell::hexahedron;
    case ElementShape::tet10:
      return VtuCell::tetra10;
    case ElementShape::hex20:
      return VtuCell::hexahedron20;
    case ElementShape::hex27:
      return VtuCell::hexahedron27;
  }
  throw std::invalid_argument("vtu: an element shape without a cell");
}

/// RFC 4648, section 4, with padding.
std::string base64(std::span<const unsigned char> bytes) {
  static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t j = 0; j < 3; ++j) group = group << 8 | (j < count ? bytes[i + j] : 0u);
    for (std::size_t j = 0; j < 4; ++j) text += j <= count ? digits[group >> (18 - 6 * j) & 63] : '=';
  }
  return text;
}

template <class T>
constexpr std::string_view type_name = "";
template <>
constexpr std::string_view type_name<double> = "Float64";
template <>
constexpr std::string_view type_name<std::int64_t> = "Int64";
template <>
constexpr std::string_view type_name<std::uint8_t> = "UInt8";

/// One array: the number of bytes and the bytes, encoded together.
template <class T>
std::string data_array(std::string_view attributes, std::span<const T> values) {
  const std::uint64_t size = values.size_bytes();
  std::vector<unsigned char> bytes(sizeof size + size);
  std::memcpy(bytes.data(), &size, sizeof size);
  if (size > 0) std::memcpy(bytes.data() + sizeof size, values.data(), size);
  return fmt::format("<DataArray type=\"{}\" {} format=\"binary\">{}</DataArray>\n", type_name<T>, attributes,
                     base64(bytes));
}

/// Values as VTK has them: vectors in the plane get a third component, zero.
Matrix<double> padded(const Matrix<double>& values) {
  if (values.rows() != 2) return values;
  Matrix<double> out = Matrix<double>::Zero(3, values.cols());
  out.topRows(2) = values;
  return out;
}

std::string named_array(const std::string& name, const Matrix<double>& given) {
  const Matrix<double> values = padded(given);
  std::string attributes = fmt::format("Name=\"{}\" NumberOfComponents=\"{}\"", escape(name), values.rows());
  constexpr std::array<const char*, 6> of_tensor = {"xx", "yy", "zz", "xy", "yz", "xz"};
  for (std::size_t i = 0; values.rows() == 6 && i < of_tensor.size(); ++i)
    attributes += fmt::format(" ComponentName{}=\"{}\"", i, of_tensor[i]);
  return data_array(attributes, std::span<const double>(values.data(), static_cast<std::size_t>(values.size())));
}

std::string fields(const std::vector<VtuField>& fields, Eigen::Index count, std::string_view of) {
  std::string out;
  for (const VtuField& field : fields) {
    const Eigen::Index rows = field.values.rows();
    if (rows != 1 && rows != 2 && rows != 3 && rows != 6) {
      throw std::invalid_argument(
          fmt::format("vtu: field '{}' has {} components; allowed: 1, 2, 3, 6", field.name, rows));
    }
    if (field.values.cols() != count) {
      throw std::invalid_argument(
          fmt::format("vtu: field '{}' has {} values for {} {}", field.name, field.values.cols(), count, of));
    }
    out += named_array(field.name, field.values);
  }
  return out;
}

std::string cells(const VtuData& data) {
  std::vector<std::int64_t> connectivity(data.connectivity.begin(), data.connectivity.end());
  std::vector<std::int64_t> offsets;
  std::vector<std::uint8_t> types;
  std::int64_t end = 0;
  for (const VtuCell cell : data.cells) {
    end += points_of(cell);
    offsets.push_back(end);
    types.push_back(static_cast<std::uint8_t>(cell));
  }
  if (end != static_cast<std::int64_t>(connectivity.size())) {
    throw std::invalid_argument(fmt::format("vtu: the cells have {} points, not {}", end, connectivity.size()));
  }
  for (const std::int64_t point : connectivity) {
    if (point < 0 || point >= data.points.cols()) {
      throw std::invalid_argument(fmt::format("vtu: a cell names point {} of {}", point, data.points.cols()));
    }
  }
  return data_array<std::int64_t>("Name=\"connectivity\"", connectivity) +
         data_array<std::int64_t>("Name=\"offsets\"", offsets) + data_array<std::uint8_t>("Name=\"types\"", types);
}

}  // namespace

void append_mesh(VtuData& data, const Mesh& mesh, const Points<double>& coordinates) {
  if (coordinates.cols() != mesh.node_count) throw std::invalid_argument("append_mesh: one column per node");
  if (data.points.cols() > 0 && data.points.rows() != coordinates.rows()) {
    throw std::invalid_argument("append_mesh: bodies of unlike dimension");
  }
  const Eigen::Index first = data.points.cols();
  data.points.conservativeResize(coordinates.rows(), first + coordinates.cols());
  data.points.rightCols(coordinates.cols()) = coordinates;
  data.cells.insert(data.cells.end(), static_cast<std::size_t>(mesh.element_count()), cell_of(mesh.shape));
  for (const int node : mesh.connectivity) data.connectivity.push_back(static_cast<int>(first) + node);
}

std::string vtu_text(const VtuData& data) {
  if (data.points.cols() > 0 && data.points.rows() != 2 && data.points.rows() != 3) {
    throw std::invalid_argument("vtu: points have 2 or 3 coordinates");
  }
  const auto cell_count = static_cast<Eigen::Index>(data.cells.size());
  std::string out = fmt::format(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"{}\" header_type=\"UInt64\">\n"
      "<UnstructuredGrid>\n"
      "<FieldData>\n",
      byte_order);
  out += data_array("Name=\"TimeValue\" NumberOfTuples=\"1\"", std::span<const double>(&data.time, 1));
  out +=
      fmt::format("</FieldData>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n", data.points.cols(), cell_count);
  out +=
      "<Points>\n" + named_array("Points", data.points.cols() > 0 ? data.points : Points<double>(3, 0)) + "</Points>\n";
  out += "<Cells>\n" + cells(data) + "</Cells>\n";
  out += "<PointData>\n" + fields(data.point_fields, data.points.cols(), "points") + "</PointData>\n";
  out += "<CellData>\n" + fields(data.cell_fields, cell_count, "cells") + "</CellData>\n";
  return out + "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
}

std::string pvd_text(const std::vector<PvdEntry>& entries) {
  std::string out = fmt::format(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"{}\">\n"
      "<Collection>\n",
      byte_order);
  for (const PvdEntry& entry : entries) {
    // fmt writes the shortest text that reads back as the same double.
    out += fmt::format("<DataSet timestep=\"{}\" group=\"\" part=\"{}\" file=\"{}\"/>\n", entry.time, entry.part,
                       escape(entry.file));
  }
  return out + "</Collection>\n</VTKFile>\n";
}

}  // namespace stickslip
