/// The files of the methods in this folder: one a method of the closed set (methods/options.hpp). They are compiled in
/// double; who wants another scalar includes them.
#pragma once

#include "methods/monolithic.hpp"
#include "methods/penalty.hpp"
#include "methods/uzawa.hpp"
