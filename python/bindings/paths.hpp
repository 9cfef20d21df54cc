#pragma once

#include <pybind11/pybind11.h>

#include <string>

namespace pdoik::python {

/// A str, which may be a path or a file's text, or an os.PathLike.
struct PathOrText {
  std::string value;
};

}  // namespace pdoik::python

template <>
struct pybind11::detail::type_caster<pdoik::python::PathOrText> {
  PYBIND11_TYPE_CASTER(pdoik::python::PathOrText, const_name("str | os.PathLike[str]"));
  bool load(handle source, bool) {
    if (!isinstance<str>(source) && !hasattr(source, "__fspath__")) return false;
    const auto text = reinterpret_steal<object>(PyOS_FSPath(source.ptr()));
    if (!text) throw error_already_set();
    if (!isinstance<str>(text)) return false;
    value.value = text.attr("encode")("utf-8", "surrogateescape").cast<std::string>();
    return true;
  }
};
