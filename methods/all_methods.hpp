/// The files of the methods in this folder: one a method of the closed set (methods/options.hpp).
#pragma once

#include "methods/monolithic.hpp"
#include "methods/penalty.hpp"
#include "methods/uzawa.hpp"
