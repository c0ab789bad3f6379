// A stand-in for the interfaces of the Modelica Standard Library that FlexArm uses, for tools that come without it.
// Connectors are those of the standard; icons are empty.
package Modelica "Interfaces of the Modelica Standard Library"
  package Icons
    partial class Package
    end Package;
    partial class InternalPackage
    end InternalPackage;
    partial class ExamplesPackage
    end ExamplesPackage;
    partial class TypesPackage
    end TypesPackage;
    partial class RecordsPackage
    end RecordsPackage;
    partial model Example
    end Example;
    partial function Function
    end Function;
    partial record Record
    end Record;
  end Icons;
  package Units
    package SI
      type Angle = Real(unit = "rad");
      type AngularVelocity = Real(unit = "rad/s");
      type Torque = Real(unit = "N.m");
      type Time = Real(unit = "s");
    end SI;
  end Units;
  package Blocks
    package Icons
      partial block DiscreteBlock
      end DiscreteBlock;
    end Icons;
    package Interfaces
      connector RealInput = input Real;
      connector RealOutput = output Real;
    end Interfaces;
  end Blocks;
  package Mechanics
    package Rotational
      package Interfaces
        connector Flange_a
          Modelica.Units.SI.Angle phi;
          flow Modelica.Units.SI.Torque tau;
        end Flange_a;
        connector Flange_b
          Modelica.Units.SI.Angle phi;
          flow Modelica.Units.SI.Torque tau;
        end Flange_b;
      end Interfaces;
    end Rotational;
  end Mechanics;
  package Utilities
    package Files
      function loadResource
        input String uri;
        output String fileReference;
      algorithm
        fileReference := uri;
      end loadResource;
    end Files;
  end Utilities;
end Modelica;
