/// The files of the methods in this folder: one a method of the closed set (methods/options.hpp).
#pragma once

#include "sensitivity/monolithic.hpp"
#include "sensitivity/penalty.hpp"
#include "sensitivity/uzawa.hpp"
