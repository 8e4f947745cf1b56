# In the preset tsan: the check threads-race-free of every model, and that it can fail.

add_custom_target(race_saboteurs DEPENDS saboteur_threads-race-free saboteur_threads-race-free.near)

function(add_race_test name library)
    add_test(NAME "races: ${name}" COMMAND pelorus-conform "${library}" --only threads-race-free ${ARGN})
    set_tests_properties("races: ${name}" PROPERTIES LABELS tsan TIMEOUT 300
                         FAIL_REGULAR_EXPRESSION "skipped threads-race-free: this (runner|library)")
endfunction()

get_property(plugins GLOBAL PROPERTY PELORUS_PLUGINS)
foreach(plugin IN LISTS plugins)
    if(NOT plugin MATCHES "^(motion|sensor|estimator|extent|partitioner|waveform|trajectory)_(.*)$")
        continue()
    endif()
    set(subjects "${PROJECT_SOURCE_DIR}/plugins/${CMAKE_MATCH_1}/${CMAKE_MATCH_2}/conformance.yaml")
    if(EXISTS "${subjects}")
        add_race_test(${plugin} "$<TARGET_FILE:${plugin}>" "--subjects=${subjects}")
    else()
        add_race_test(${plugin} "$<TARGET_FILE:${plugin}>")
    endif()
endforeach()
add_race_test("a near-miss" "$<TARGET_FILE:saboteur_threads-race-free.near>")
add_race_test("a saboteur" "$<TARGET_FILE:saboteur_threads-race-free>")
# The line that is told is the saboteur's own.
set_tests_properties("races: a saboteur" PROPERTIES
                     PASS_REGULAR_EXPRESSION "FAIL +threads-race-free.*data-race: .*written at .*model.cpp:[0-9]+")
