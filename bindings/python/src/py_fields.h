/* SPDX-License-Identifier: Apache-2.0 */
/** @file
 * A plain C struct as a Python value class, from a list of its fields: attributes, a constructor by
 * keywords, comparison and a readable form. */
#ifndef OPMS_PY_FIELDS_H
#define OPMS_PY_FIELDS_H

#include <algorithm>
#include <array>
#include <string>

#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/string.h>

namespace nb = nanobind;

/** How a member looks in Python: as it is, */
template <class Member> struct PyForm {
    using Value = Member;
    static Value get(const Member &member) { return member; }
    static void set(Member &member, const Value &value) { member = value; }
};

/** an array as a list of exactly so many, */
template <class Item, size_t N> struct PyForm<Item[N]> {
    using Value = std::array<Item, N>;
    static Value get(const Item (&member)[N])
    {
        Value value;
        std::copy_n(member, N, value.begin());
        return value;
    }
    static void set(Item (&member)[N], const Value &value)
    {
        std::copy_n(value.begin(), N, member);
    }
};

/** and text as a str. */
template <size_t N> struct PyForm<char[N]> {
    using Value = std::string;
    static Value get(const char (&member)[N])
    {
        return Value(member, std::find(member, member + N, '\0'));
    }
    static void set(char (&member)[N], const Value &value)
    {
        if (value.size() >= N) {
            throw nb::value_error("the text is too long");
        }
        std::fill_n(member, N, '\0');
        std::copy(value.begin(), value.end(), member);
    }
};

template <class Struct, class Member> struct PyField {
    const char *name;
    Member Struct::*member;
    const char *doc;
    using Form = PyForm<Member>;
    using Value = typename Form::Value;

    /** Take the field's value out of the keywords, if it is among them. */
    size_t take(Struct &to, const nb::kwargs &from) const
    {
        if (!from.contains(name)) {
            return 0;
        }
        Value value{};
        if (!nb::try_cast<Value>(from[name], value)) {
            throw nb::type_error((std::string(name) + " has a wrong type or range").c_str());
        }
        Form::set(to.*member, value);
        return 1;
    }

    nb::object python(const Struct &of) const { return nb::cast(Form::get(of.*member)); }

    std::string text(const Struct &of) const
    {
        return std::string(name) + "=" + nb::repr(python(of)).c_str();
    }
};

template <class Struct, class Member>
PyField<Struct, Member> py_field(const char *name, Member Struct::*member, const char *doc)
{
    return {name, member, doc};
}

template <class Struct, class Member>
void py_bind_attribute(nb::class_<Struct> &bound, PyField<Struct, Member> field)
{
    using Form = PyForm<Member>;
    Member Struct::*const member = field.member;
    bound.def_prop_rw(
        field.name, [member](const Struct &self) { return Form::get(self.*member); },
        [member](Struct &self, const typename Form::Value &value) {
            Form::set(self.*member, value);
        },
        field.doc);
}

template <class Struct, class... Members>
void py_bind_fields(nb::module_ &module, const char *type, const char *doc,
                    PyField<Struct, Members>... fields)
{
    nb::class_<Struct> bound(module, type, doc);
    bound.def(
        "__init__",
        [fields...](Struct *self, const nb::kwargs &values) {
            new (self) Struct();
            if ((fields.take(*self, values) + ...) != values.size()) {
                throw nb::type_error("there is no such field");
            }
        },
        "Fields by keyword; those that are not given are 0.");
    (py_bind_attribute(bound, fields), ...);
    bound.def(
        "__eq__",
        [fields...](const Struct &self, const Struct &other) {
            return (fields.python(self).equal(fields.python(other)) && ...);
        },
        nb::is_operator(), "Are all fields equal?");
    const std::string name = type;
    bound.def("__repr__", [name, fields...](const Struct &self) {
        std::string text;
        ((text += (text.empty() ? "" : ", ") + fields.text(self)), ...);
        return name + "(" + text + ")";
    });
}

#endif
