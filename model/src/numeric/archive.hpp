#pragma once

#include <array>
#include <cstddef>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <Eigen/Geometry>

/// Values as bytes, in the order in which they are given, as this machine holds them. A class says once what
/// it consists of, for writing and reading:
///
///     template <typename Archive, typename Self>
///     static void describe(Archive& archive, Self& self) { archive(self.first_, self.second_); }
namespace fringe::detail {

/// The bytes of an archive end before the values do.
class ArchiveEnds : public std::runtime_error {
 public:
  ArchiveEnds() : std::runtime_error("the archive ends too early") {}
};

template <typename T>
concept PlainNumber = std::is_arithmetic_v<T> || std::is_enum_v<T>;

/// Coordinates that lie in an array one after the other.
template <typename T>
concept PlainElement =
    PlainNumber<T> || std::is_same_v<T, Eigen::Vector3d> || std::is_same_v<T, Eigen::Vector3f>;

/// Writes values.
class ArchiveWriter {
 public:
  template <typename... Values>
  void operator()(const Values&... values) {
    (write(values), ...);
  }

  const std::string& bytes() const { return bytes_; }

 private:
  void append(const void* data, std::size_t size) { bytes_.append(static_cast<const char*>(data), size); }

  template <PlainNumber T>
  void write(const T& value) {
    append(&value, sizeof value);
  }
  void write(const std::string& text) {
    write(text.size());
    append(text.data(), text.size());
  }
  template <typename T>
  void write(const std::optional<T>& value) {
    write(value.has_value());
    if (value)
      write(*value);
  }
  template <typename T, std::size_t size>
  void write(const std::array<T, size>& values) {
    for (const T& value : values)
      write(value);
  }
  template <typename T>
  void write(const std::vector<T>& values) {
    write(values.size());
    if constexpr (PlainElement<T>)
      append(values.data(), values.size() * sizeof(T));
    else
      for (const T& value : values)
        write(value);
  }
  template <typename Scalar, int rows, int columns, int options>
  void write(const Eigen::Matrix<Scalar, rows, columns, options>& matrix) {
    write(matrix.rows());
    write(matrix.cols());
    append(matrix.data(), static_cast<std::size_t>(matrix.size()) * sizeof(Scalar));
  }
  void write(const Eigen::Isometry3d& pose) { write(pose.matrix()); }
  void write(const Eigen::AlignedBox3d& box) {
    write(box.min());
    write(box.max());
  }
  template <typename T>
  requires requires(ArchiveWriter& archive, const T& value) { T::describe(archive, value); }
  void write(const T& value) { T::describe(*this, value); }

  std::string bytes_;
};

/// Reads what an ArchiveWriter wrote. Throws ArchiveEnds where there is less.
class ArchiveReader {
 public:
  /// Reads bytes that have to outlive the reader.
  explicit ArchiveReader(std::string_view bytes) : bytes_(bytes) {}

  template <typename... Values>
  void operator()(Values&... values) {
    (read(values), ...);
  }

 private:
  void take(void* data, std::size_t size) {
    if (size > bytes_.size())
      throw ArchiveEnds();
    // An empty array may have a null address, which memcpy must not be given.
    if (size > 0)
      std::memcpy(data, bytes_.data(), size);
    bytes_.remove_prefix(size);
  }
  /// Returns a number of elements that there may be.
  std::size_t count(std::size_t size_of_one) {
    std::size_t size = 0;
    read(size);
    if (size > bytes_.size() / size_of_one)
      throw ArchiveEnds();
    return size;
  }

  template <PlainNumber T>
  void read(T& value) {
    take(&value, sizeof value);
  }
  void read(std::string& text) {
    text.resize(count(1));
    take(text.data(), text.size());
  }
  template <typename T>
  void read(std::optional<T>& value) {
    bool is_there = false;
    read(is_there);
    value.reset();
    if (is_there)
      read(value.emplace());
  }
  template <typename T, std::size_t size>
  void read(std::array<T, size>& values) {
    for (T& value : values)
      read(value);
  }
  template <typename T>
  void read(std::vector<T>& values) {
    values.resize(count(PlainElement<T> ? sizeof(T) : 1));
    if constexpr (PlainElement<T>)
      take(values.data(), values.size() * sizeof(T));
    else
      for (T& value : values)
        read(value);
  }
  template <typename Scalar, int rows, int columns, int options>
  void read(Eigen::Matrix<Scalar, rows, columns, options>& matrix) {
    Eigen::Index height = 0, width = 0;
    read(height);
    read(width);
    const auto most = static_cast<Eigen::Index>(bytes_.size() / sizeof(Scalar));
    if (height < 0 || width < 0 || (width > 0 && height > most / width))
      throw ArchiveEnds();
    if constexpr (rows == Eigen::Dynamic || columns == Eigen::Dynamic)
      matrix.resize(height, width);
    else if (height != rows || width != columns)
      throw ArchiveEnds();
    take(matrix.data(), static_cast<std::size_t>(matrix.size()) * sizeof(Scalar));
  }
  void read(Eigen::Isometry3d& pose) { read(pose.matrix()); }
  void read(Eigen::AlignedBox3d& box) {
    read(box.min());
    read(box.max());
  }
  template <typename T>
  requires requires(ArchiveReader& archive, T& value) { T::describe(archive, value); }
  void read(T& value) { T::describe(*this, value); }

  std::string_view bytes_;
};

/// Returns the bytes of values.
template <typename... Values>
std::string bytes_of(const Values&... values) {
  ArchiveWriter archive;
  archive(values...);
  return archive.bytes();
}

}  // namespace fringe::detail
