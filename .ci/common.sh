# Sourced by the scripts beside it, with the top folder of the project as working folder.

# `jazzy` where ROS 2 Jazzy is sourced, else `venv`.
if [ "${ROS_DISTRO:-}" = jazzy ]; then
    environment=jazzy
else
    environment=venv
fi

say() {
    printf '%s\n' "==> $*"
}

fail() {
    printf '%s\n' "error: $*" >&2
    exit 1
}

# The wheels' start-up hook leaves this behind; a python of another environment that finds it
# would not set up its own libraries.
unset _ROS_WHEELS_BOOTSTRAP_COMPLETE
# What another environment or another ROS left in this shell must not be mixed into .venv.
if [ "$environment" = venv ]; then
    unset PYTHONPATH PYTHONHOME LD_LIBRARY_PATH COLCON_PREFIX_PATH
fi

# Makes the environment's commands and libraries the ones in force in this shell.
enter_environment() {
    if [ "$environment" = venv ]; then
        . .venv/bin/activate
        export AMENT_PREFIX_PATH="$VIRTUAL_ENV" CMAKE_PREFIX_PATH="$VIRTUAL_ENV"
    fi
}
